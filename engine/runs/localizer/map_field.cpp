#include "map_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>
#include <utility>

#include "engine/core/quantile.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/yaml/yaml_file.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/localizer/obstacle_field.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/map_files.hpp"

namespace gdtslam {

std::optional<std::string> find_run_folder(const std::string& map) {
  namespace fs = std::filesystem;
  if (RunReader::is_run(map)) return map;
  const std::string parent = fs::path(map).has_parent_path() ? fs::path(map).parent_path().string() : ".";
  return RunReader::is_run(parent) ? std::optional(parent) : std::nullopt;
}

FitLimit make_fit_limit(std::vector<double> own_m, double resolution_m) {
  const FitLimit of_cells{2.0 * resolution_m, FitLimit::Source::kResolution, resolution_m};
  if (own_m.empty()) return of_cells;
  std::sort(own_m.begin(), own_m.end());
  const double usual_m = quantile_of_sorted(own_m, 0.5);
  const double most_m = quantile_of_sorted(own_m, 0.99);
  if (most_m < of_cells.distance_m) return {of_cells.distance_m, of_cells.source, usual_m};
  return {most_m, FitLimit::Source::kRun, usual_m};
}

namespace {

// The description of a map: the file itself, or the one in the folder.
std::string find_description(const std::string& map) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::is_directory(map, ignored)) {
    refuse_broken_run(map, "gdt.yaml");
    return (fs::path(map) / "gdt.yaml").string();
  }
  if (!fs::is_regular_file(map, ignored)) return map;  // reading it says what is wrong
  if (!looks_like_map(map)) {
    throw InputError({map, 0},
                     "is no map; give the folder that 'gdtslam map -o' wrote, its gdt.yaml, or a map.yaml of "
                     "map_server");
  }
  return map;
}

// Cells far smaller than a laser's resolution, or larger than any room, are a mistake in the file.
void check_geometry(const GridGeometry& grid, const std::string& path) {
  constexpr double kFinest_m = 0.001;
  constexpr double kCoarsest_m = 1.0;
  constexpr double kMostDistant_m = 1.0e8;
  if (!(grid.resolution_m >= kFinest_m && grid.resolution_m <= kCoarsest_m)) {
    throw InputError({path, 0}, fmt::format("a resolution of {:g} m is not between {:g} and {:g} m, so no scan can be "
                                            "searched in the map; is it in metres?",
                                            grid.resolution_m, kFinest_m, kCoarsest_m));
  }
  if (!(std::fabs(grid.origin_x_m) <= kMostDistant_m && std::fabs(grid.origin_y_m) <= kMostDistant_m)) {
    throw InputError({path, 0},
                     fmt::format("the origin lies more than {:g} m away; was the file edited?", kMostDistant_m));
  }
}

// The memory for a map depends on its cells, not on its packed picture: the field, data for searches, and the tracker's
// map.
void check_memory(const ObstacleFieldSize& size, const std::string& path) {
  constexpr std::uint64_t kFieldBytesPerCell = 2 * sizeof(std::uint16_t);
  const std::uint64_t derived =
      kFieldBytesPerCell * size.width * size.height + CertifiedMap::most_bytes(size.width, size.height);
  std::error_code ignored;  // a file that cannot be examined counts as empty
  const std::uintmax_t picture = std::filesystem::file_size(DescriptionFile(path).image_path(), ignored);
  check_derived_bytes(derived, ignored ? 0 : picture, path, "searching in the map");
}

MapField field_of_occupied(const std::string& path, const MapConfig& config) {
  const OccupancyMap map = read_occupancy_map(path);
  check_geometry(map.geometry, path);
  MapField field;
  field.path = path;
  field.source = MapField::Source::kOccupiedCells;
  const std::uint32_t radius = obstacle_radius(config.truncation_m, map.geometry.resolution_m);
  ObstacleFieldSize size;
  try {
    size = obstacle_field_size(map, radius);
  } catch (const InputError& error) {
    throw InputError({path, 0}, error.what());
  }
  check_memory(size, path);
  field.file = obstacle_field(map, radius);
  if (field.file.cells.empty()) {
    throw InputError(
        {path, 0},
        "the map has no occupied cell, so no scan can be found in it; are occupied_thresh and negate right?");
  }
  field.kernel_origin_m = {field.file.geometry.origin_x_m, field.file.geometry.origin_y_m};
  return field;
}

// The kernels count in cells of the map's grid, whose origin must lie on it.
void check_lattice(const MapField& field) {
  const GridGeometry& grid = field.file.geometry;
  constexpr double kFarthest = 1.0e6;
  if (!(std::fabs(grid.origin_x_m / grid.resolution_m) < kFarthest &&
        std::fabs(grid.origin_y_m / grid.resolution_m) < kFarthest)) {
    throw InputError({field.path, 0}, "the origin lies more than a million cells from the map's; was the file edited?");
  }
}

}  // namespace

FieldView MapField::view() const {
  const GridGeometry& grid = file.geometry;
  const auto whole_cells = [&grid](double distance_m) {
    return static_cast<std::int32_t>(std::lround(distance_m / grid.resolution_m));
  };
  return {.cells = file.cells.data(),
          .width = static_cast<std::uint32_t>(grid.width),
          .height = static_cast<std::uint32_t>(grid.height),
          .stride = static_cast<std::uint32_t>(grid.width),
          .first_cell = {whole_cells(grid.origin_x_m - kernel_origin_m.x()),
                         whole_cells(grid.origin_y_m - kernel_origin_m.y())},
          .cap = file.cap,
          .resolution_m = grid.resolution_m};
}

PoseWindow MapField::known_window() const {
  const GridGeometry& grid = file.geometry;
  CellBox known{{grid.width, grid.height}, {0, 0}};
  for (std::int32_t y = 0; y < grid.height; ++y) {
    for (std::int32_t x = 0; x < grid.width; ++x) {
      if (file.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width) +
                     static_cast<std::size_t>(x)] >= file.cap) {
        continue;
      }
      known.min = {std::min(known.min.x, x), std::min(known.min.y, y)};
      known.end = {std::max(known.end.x, x + 1), std::max(known.end.y, y + 1)};
    }
  }
  if (known.empty()) throw InputError({path, 0}, "the map knows no obstacle, so no scan can be found in it");
  const double r = grid.resolution_m;
  return {.centre = {grid.origin_x_m + 0.5 * r * (known.min.x + known.end.x),
                     grid.origin_y_m + 0.5 * r * (known.min.y + known.end.y), 0.0},
          .half_x_m = 0.5 * r * known.width(),
          .half_y_m = 0.5 * r * known.height(),
          .half_theta_rad = kPi};
}

MapField framed(MapField field) {
  constexpr std::int32_t kFrame = 2;
  const DistanceFieldFile& file = field.file;
  const GridGeometry& grid = file.geometry;
  const auto width = static_cast<std::size_t>(grid.width);
  const auto height = static_cast<std::size_t>(grid.height);
  const auto row = [&file, width](std::size_t y) { return std::span(file.cells).subspan(y * width, width); };
  const auto is_cap = [cap = file.cap](std::uint16_t cell) { return cell == cap; };
  const auto holds_cap = [&](std::span<const std::uint16_t> cells) { return std::ranges::all_of(cells, is_cap); };
  bool is_framed = width > 2 * kFrame && height > 2 * kFrame;
  for (std::size_t y = 0; is_framed && y < height; ++y) {
    const bool is_edge = y < kFrame || y >= height - kFrame;
    is_framed = is_edge ? holds_cap(row(y)) : holds_cap(row(y).first(kFrame)) && holds_cap(row(y).last(kFrame));
  }
  if (is_framed) return field;
  const double margin_m = kFrame * grid.resolution_m;
  DistanceFieldFile wide{{grid.resolution_m, grid.origin_x_m - margin_m, grid.origin_y_m - margin_m,
                          grid.width + 2 * kFrame, grid.height + 2 * kFrame},
                         {},
                         file.cap};
  wide.cells.assign(wide.geometry.cell_count(), file.cap);
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t begin = (y + kFrame) * (width + 2 * kFrame) + kFrame;
    std::ranges::copy(row(y), wide.cells.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  field.file = std::move(wide);
  return field;
}

bool is_occupancy_map(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  const DescriptionFile file(path);
  return file.has("occupied_thresh") || !(file.has("version") || file.has("scale") || file.has("cap"));
}

bool looks_like_map(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const std::string ending = fs::path(path).extension().string();
  return ending == ".yaml" || ending == ".yml" || fs::exists(fs::path(path) / "gdt.yaml", ignored);
}

namespace {

// The run of the folder, if its report lists its files. Files of an older run are not checked.
std::optional<RunReader> told_run_in(const std::string& map) {
  if (!RunReader::is_run(map)) return std::nullopt;
  RunReader run(map);
  return run.files().is_told() ? std::optional(std::move(run)) : std::nullopt;
}

// A tile to search in: the one at the origin if it exists, else any; empty if there is none.
std::string tile_in(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const char* name : {"map_0_0.yaml", "gdt_0_0.yaml"}) {
    if (std::filesystem::exists(folder / name, ignored)) return name;
  }
  std::string first;
  for (std::filesystem::directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
    const std::string name = at->path().filename().string();
    if (!name.ends_with(".yaml") || !(name.starts_with("map_") || name.starts_with("gdt_"))) continue;
    if (first.empty() || name < first) first = name;
  }
  return first;
}

// A site in tiles has no field as a whole.
void require_one_piece(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code ignored;  // reading reports a folder that cannot be examined
  if (std::filesystem::exists(path, ignored) || !std::filesystem::exists(folder / "tiles" / "index.json", ignored))
    return;
  const std::string tile = tile_in(folder / "tiles");
  throw InputError({folder.string(), 0},
                   fmt::format("has its map in tiles: {}cut a piece out with 'gdtslam edit RUN --crop X0,Y0,X1,Y1 "
                               "-o DIR'",
                               tile.empty() ? "" : fmt::format("name one of them, as tiles/{}, or ", tile)));
}

// Distances alone show only walls, which reach half a cell from an obstacle. Cells farther away may be floor or not.
OccupancyMap walls_of_field(const DistanceFieldView& view) {
  OccupancyMap map{.geometry = view.geometry, .cells = CellStates(view.geometry.cell_count())};
  std::size_t cell = 0;
  for (std::int32_t y = 0; y < view.geometry.height; ++y) {
    for (std::int32_t x = 0; x < view.geometry.width; ++x, ++cell) {
      if (view.at({x, y}) <= kWallOfField) map.cells.set(cell, CellState::kOccupied);
    }
  }
  return map;
}

}  // namespace

OccupancyMap shown_map(const MapField& field) {
  if (field.source == MapField::Source::kOccupiedCells) return read_occupancy_map(field.path);
  if (field.run && field.run->summary().map) return field.run->map();
  return walls_of_field(field.file.view());
}

MapField read_map_field(const std::string& map, const MapConfig& config) {
  const std::string path = find_description(map);
  std::optional<RunReader> run = told_run_in(map);
  if (!run && is_occupancy_map(path)) return field_of_occupied(path, config);
  require_one_piece(path);
  MapField field;
  field.path = path;
  field.run = std::move(run);
  field.file = field.run ? field.run->field() : read_distance_field(path);
  check_lattice(field);
  const GridGeometry& grid = field.file.geometry;
  check_memory({static_cast<std::uint64_t>(grid.width), static_cast<std::uint64_t>(grid.height)}, path);
  return field;
}

}  // namespace gdtslam
