#include "changes_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "engine/drawing/maps/map_pictures.hpp"
#include "engine/io/atomic_file.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"

namespace gdtslam {
namespace {

ChangesLayer layer_of(const std::vector<ChangedCell>& cells) {
  ChangesLayer layer;
  layer.cells.reserve(cells.size());
  for (const ChangedCell& changed : cells) layer.cells.push_back({changed.cell, changed.patch});
  layer.patches = static_cast<std::uint32_t>(count_patches(cells));
  return layer;
}

double area_m2(const DriveChanges& seen, const std::vector<ChangedCell>& cells) {
  const double r = seen.map().geometry.resolution_m;
  return r * r * static_cast<double>(cells.size());
}

nlohmann::ordered_json cells_json(const DriveChanges& seen, const std::vector<ChangedCell>& cells) {
  return {{"places", count_patches(cells)}, {"cells", cells.size()}, {"area_m2", area_m2(seen, cells)}};
}

PictureSize size_of(const OccupancyMap& map) { return size_for_content(map.geometry.width, map.geometry.height); }

}  // namespace

std::string changes_table_file(const std::string& picture) {
  return std::filesystem::path(picture).replace_extension(".csv").string();
}

void write_changes(const std::string& picture, const LocalizeJob& job, const DriveChanges& seen,
                   const MapChanges& changes) {
  MapLook look;
  look.title = "What changed in the map, as " + std::filesystem::path(job.log).filename().string() + " shows it";
  look.subtitle = fmt::format(
      "{} views from {:g} cm apart; new: at least {} of them end there, gone: as many pass through; away from walls by "
      "{:g} cm",
      seen.views(), 100.0 * seen.limits().spacing_m, seen.limits().least_views, 100.0 * seen.limits().tolerance_m);
  const ChangesOverlay overlay{layer_of(changes.appeared), layer_of(changes.gone), seen.stretches()};
  write_file_atomically(picture,
                        drawing_bytes(changes_picture(seen.map(), overlay, look, size_of(seen.map())), picture));
  write_file_atomically(changes_table_file(picture), changes_table(seen.map().geometry, changes));
}

std::string as_text(const DriveChanges& seen, const MapChanges& changes) {
  const auto part = [](const char* what, const std::vector<ChangedCell>& cells) {
    const std::size_t places = count_patches(cells);
    return fmt::format("{} in {} place{}, {} cells", what, places, places == 1 ? "" : "s", cells.size());
  };
  return fmt::format("changes by {} views: {}; {}\n", seen.views(), part("new", changes.appeared),
                     part("gone", changes.gone));
}

nlohmann::ordered_json as_json(const DriveChanges& seen, const MapChanges& changes) {
  return {{"views", seen.views()},
          {"tolerance_m", seen.limits().tolerance_m},
          {"least_views", seen.limits().least_views},
          {"new", cells_json(seen, changes.appeared)},
          {"gone", cells_json(seen, changes.gone)}};
}

}  // namespace gdtslam
