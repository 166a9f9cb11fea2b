// The studio's views that need no OpenGL: maps, fields, plots, drawings.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "engine/drawing/linkage/linkage_drawing.hpp"
#include "engine/runs/evaluation/errors.hpp"
#include "engine/runs/inputs/given_files.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "loops_film.hpp"
#include "studio.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kShownCells = 12;
constexpr std::size_t kMostCells = 60;
constexpr std::size_t kShownSwings = 8;   // of an elevation over time: more could not be told apart
constexpr std::uint16_t kHalfCell = 128;  // of the field's 1/256 cell: where scans were merged, obstacles are near 0

// The obstacle that is nearest to the middle of the field.
CellIndex middle_obstacle(const FieldPicture& field) {
  const GridGeometry& grid = field.geometry;
  CellIndex best{grid.width / 2, grid.height / 2};
  std::int64_t sq_best = std::numeric_limits<std::int64_t>::max();
  for (std::int32_t y = 0; y < grid.height; ++y) {
    for (std::int32_t x = 0; x < grid.width; ++x) {
      const std::size_t index =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(x);
      if (field.cells[index] >= kHalfCell) continue;
      const std::int64_t dx = x - grid.width / 2;
      const std::int64_t dy = y - grid.height / 2;
      if (dx * dx + dy * dy >= sq_best) continue;
      sq_best = dx * dx + dy * dy;
      best = {x, y};
    }
  }
  return best;
}

// So many cells a side around a cell, moved to lie inside the grid.
CellBox box_around(const GridGeometry& grid, CellIndex middle, std::size_t cells) {
  const auto side = static_cast<std::int32_t>(cells);
  const auto begin = [side](std::int32_t centre, std::int32_t end) {
    return std::clamp(centre - side / 2, 0, std::max(0, end - side));
  };
  CellBox box;
  box.min = {begin(middle.x, grid.width), begin(middle.y, grid.height)};
  box.end = {std::min(box.min.x + side, grid.width), std::min(box.min.y + side, grid.height)};
  return box;
}

// Plots are drawn small and scaled up, so that their words are as large beside their lines as on a printed page.
PictureSize plot_size(const std::optional<PictureSize>& wanted) {
  constexpr double kWidth_px = 960.0;
  const PictureSize size = wanted.value_or(kStillSize);
  const double share = std::min(1.0, kWidth_px / size.width);
  return {static_cast<std::uint32_t>(std::lround(share * size.width)),
          static_cast<std::uint32_t>(std::lround(share * size.height))};
}

/// Of an elevation over time, up and down, to where the first of them end; false where there are no more. A swing
/// counts where it rises through the middle of all elevations, after it was well below.
bool keep_first_swings(TimeSeries& series) {
  const auto by_height = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto [least, most] = std::minmax_element(series.points.begin(), series.points.end(), by_height);
  const double low = least->second + 0.25 * (most->second - least->second);
  const double middle = 0.5 * (least->second + most->second);
  std::size_t swings = 0;
  bool was_low = false;
  double first_s = series.points.front().first;
  for (std::size_t k = 0; k < series.points.size(); ++k) {
    const auto& [time_s, elevation] = series.points[k];
    was_low = was_low || elevation < low;
    if (!was_low || elevation < middle) continue;
    was_low = false;
    if (++swings == 1) first_s = time_s;
    if (swings <= kShownSwings) continue;
    // As long as so many swings are, from the log's begin.
    const double end_s = series.points.front().first + time_s - first_s;
    std::erase_if(series.points, [end_s](const auto& point) { return point.first > end_s; });
    return true;
  }
  return false;
}

// In the order of time, which relations need not be in.
std::vector<TrajectoryError> errors_of(RenderSource& source, const RenderOptions& options) {
  if (!options.relations.empty()) {
    const std::vector<Relation> relations = read_relations(options.relations);
    std::vector<TrajectoryError> errors = errors_against(source.trajectory(), relations);
    std::stable_sort(errors.begin(), errors.end(), [](const auto& a, const auto& b) { return a.stamp_s < b.stamp_s; });
    if (!errors.empty()) return errors;
    throw InputError({options.relations, 0}, fmt::format("none of its {} relations has stamps of {}; do both belong to "
                                                         "the same log?",
                                                         relations.size(), source.input()));
  }
  return errors_against(source.trajectory(), given_trajectory(options.reference));
}

}  // namespace

MapLook RenderStudio::map_look() const {
  MapLook look;
  if (!options_.no_caption) {
    look.title = title();
    look.subtitle = subtitle();
  }
  look.colour_map = colour_map_of(options_.colour_map);
  look.with_path = look.with_keyframes = !options_.no_path;
  look.is_transparent = options_.is_transparent;
  return look;
}

Canvas RenderStudio::map(const Wanted& wanted) {
  const PathOverlay overlay = first().overlay();
  if (!options_.colour_map.empty() && (options_.no_path || overlay.trajectory.empty())) {
    throw UsageError("--colour-map: has no effect on a map without its path, which alone has colours from low to high");
  }
  return map_view(first().map(), overlay, map_look(), wanted);
}

Canvas RenderStudio::graph(const Wanted& wanted) {
  const OccupancyMap& map = first().map();
  const RenderSource::Graph graph = first().graph();
  MapLook look = map_look();
  if (!options_.no_caption) look.subtitle = graph.subtitle;
  const PictureSize size = wanted.value_or(size_for_content(map.geometry.width, map.geometry.height));
  return graph_picture(map, graph.overlay, look, size);
}

Canvas RenderStudio::before_and_after_loops(const Wanted& wanted) {
  return loops_before_and_after(first(), map_look(), wanted);
}

std::unique_ptr<Film> RenderStudio::loops(const PictureSize& size, std::size_t frames) {
  constexpr std::size_t kHeldShare = 5;  // of a short film
  const auto second = static_cast<std::size_t>(std::lround(frames_per_s()));
  const LoopsFilmLength length{frames,
                               std::clamp<std::size_t>(second, 1, std::max<std::size_t>(frames / kHeldShare, 1))};
  return loops_film(first(), map_look(), size, length);
}

Canvas RenderStudio::field_still(bool is_intensity, const Wanted& wanted) {
  const FieldPicture& field = first().field();
  MapLook look = map_look();
  look.is_intensity = is_intensity;
  const PictureSize size = wanted.value_or(size_for_content(field.geometry.width, field.geometry.height));
  return field_picture(field, first().overlay(), look, size);
}

Canvas RenderStudio::linkage_sheet(const Wanted& /*wanted*/) {
  return linkage_drawing(calib::LinkageCycle(first().linkage()));
}

Canvas RenderStudio::cells(const Wanted& /*wanted*/) {
  const FieldPicture& field = first().field();
  const std::size_t count = options_.cells > 0 ? options_.cells : kShownCells;
  if (count > kMostCells) throw UsageError(fmt::format("--cells: {} is more than {} a side", count, kMostCells));
  CellIndex middle = middle_obstacle(field);
  if (!options_.at.empty()) {
    middle = field.geometry.cell_of(place_of(options_.at));
    if (!field.geometry.contains(middle)) {
      const Point2 last = field.geometry.centre_of({field.geometry.width - 1, field.geometry.height - 1});
      throw UsageError(fmt::format("--at: {} lies outside the field, which goes from {:.2f},{:.2f} to {:.2f},{:.2f} m",
                                   options_.at, field.geometry.origin_x_m, field.geometry.origin_y_m, last.x(),
                                   last.y()));
    }
  }
  MapLook look = map_look();
  look.subtitle.clear();
  return cells_picture(field, box_around(field.geometry, middle, count), options_.is_squared, look);
}

// One elevation a scan, that of its points in the middle of its time.
Canvas RenderStudio::elevation(const Wanted& wanted) {
  Cloud cloud = first().cloud({}, [this](const std::string& remark) { tell(remark); });
  std::sort(cloud.begin(), cloud.end(), [](const CloudPoint& a, const CloudPoint& b) { return a.stamp_s < b.stamp_s; });
  double begin_s = cloud.front().stamp_s;
  if (const Trajectory poses = path(); !poses.empty()) {
    const auto by_stamp = [](const StampedPose& a, const StampedPose& b) { return a.stamp_s < b.stamp_s; };
    begin_s = std::min_element(poses.begin(), poses.end(), by_stamp)->stamp_s;
  }
  const double from_s = begin_s + (options_.from.empty() ? 0.0 : time_of("--from", options_.from));
  const double to_s = options_.to.empty() ? cloud.back().stamp_s : begin_s + time_of("--to", options_.to);
  const double length_s = cloud.back().stamp_s - begin_s;
  TimeSeries series{"", {}};
  for (std::size_t k = 0; k < cloud.size();) {
    std::size_t end = k + 1;
    while (end < cloud.size() && cloud[end].scan == cloud[k].scan) ++end;
    const CloudPoint& middle = cloud[(k + end) / 2];
    if (middle.stamp_s >= from_s && middle.stamp_s <= to_s) {
      series.points.emplace_back(middle.stamp_s - begin_s, deg_from_rad(static_cast<double>(middle.elevation_rad)));
    }
    k = end;
  }
  if (series.points.empty()) throw UsageError("--from and --to leave no point of the cloud");
  const auto by_height = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto [least, most] = std::minmax_element(series.points.begin(), series.points.end(), by_height);
  if (least->second == most->second) {
    throw InputError({first().input(), 0}, "has one elevation only, so there is nothing to plot over time");
  }
  std::string heading = title();
  if (options_.from.empty() && options_.to.empty() && keep_first_swings(series)) {
    heading += fmt::format(": the first {} swings, {:.0f} of {:.0f} s (--from, --to)", kShownSwings,
                           series.points.back().first, length_s);
  }
  return time_plot(heading, "Elevation", "°", {std::move(series)}, plot_size(wanted));
}

RenderStudio::Errors RenderStudio::errors() {
  const bool is_angle = options_.is_angle;
  Errors all{{title(), is_angle ? "Heading error" : "Position error", is_angle ? "°" : "m", {}}, {}};
  const std::vector<std::string> names = distinct_names();
  std::vector<std::vector<TrajectoryError>> errors;
  double first_s = std::numeric_limits<double>::infinity();
  for (RenderSource& source : sources_) {
    errors.push_back(errors_of(source, options_));
    for (const TrajectoryError& error : errors.back()) first_s = std::min(first_s, error.stamp_s);
  }
  for (std::size_t k = 0; k < sources_.size(); ++k) {
    ErrorGroup group{names[k], {}};
    TimeSeries line{names[k], {}};
    for (const TrajectoryError& error : errors[k]) {
      group.values.push_back(is_angle ? error.angle_deg : error.position_m);
      line.points.emplace_back(error.stamp_s - first_s, group.values.back());
    }
    all.plot.groups.push_back(std::move(group));
    all.series.push_back(std::move(line));
  }
  if (sources_.size() > 1 && options_.title.empty()) all.plot.title = fmt::format("{} runs", sources_.size());
  return all;
}

Canvas RenderStudio::errors_box(const Wanted& wanted) { return box_plot(errors().plot, plot_size(wanted)); }

Canvas RenderStudio::errors_cdf(const Wanted& wanted) { return distribution_plot(errors().plot, plot_size(wanted)); }

Canvas RenderStudio::errors_time(const Wanted& wanted) {
  const Errors all = errors();
  return time_plot(all.plot.title, all.plot.quantity, all.plot.unit, all.series, plot_size(wanted));
}

}  // namespace gdtslam
