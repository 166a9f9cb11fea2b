#include "edit_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/io/byte_source.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/mapping/map/scan_beams.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

bool is_taken_out(const EndRules& rules, const Point2& end_m) {
  const auto has_it = [&end_m](const MapRegion& region) { return region.contains(end_m); };
  return std::any_of(rules.erased.begin(), rules.erased.end(), has_it) ||
         !std::all_of(rules.kept.begin(), rules.kept.end(), has_it);
}

// The first cell of a row or a column whose centre is not below the coordinate.
CellIndex first_cell_from(const GridGeometry& map, const Point2& low_m) {
  constexpr double kShareBelowCentre = 0.5 - 1.0e-6;  // a centre on the coordinate counts, whatever rounding says
  const double up_m = kShareBelowCentre * map.resolution_m;
  return map.cell_at({low_m.x() + up_m, low_m.y() + up_m});
}

// The cells of the map whose centres may lie in all of the regions.
CellBox cells_within(const GridGeometry& map, const std::vector<MapRegion>& kept) {
  CellBox box{{0, 0}, {map.width, map.height}};
  for (const MapRegion& region : kept) {
    const RegionBounds bounds = region_bounds(region);
    const CellIndex low = first_cell_from(map, bounds.low_m);
    const CellIndex end = first_cell_from(map, bounds.high_m);
    box.min = {std::max(box.min.x, low.x), std::max(box.min.y, low.y)};
    box.end = {std::min(box.end.x, end.x), std::min(box.end.y, end.y)};
  }
  return box;
}

// The origin of a part on the map's lattice, whose cells lie at whole multiples of their size.
double origin_of_part(double origin_m, double resolution_m, std::int32_t cells) {
  return (std::floor(origin_m / resolution_m + 0.5) + static_cast<double>(cells)) * resolution_m;
}

}  // namespace

bool MapRegion::contains(const Point2& point_m) const {
  bool is_inside = false;
  for (std::size_t k = 0, last = corners_m.size() - 1; k < corners_m.size(); last = k++) {
    const Point2& a = corners_m[k];
    const Point2& b = corners_m[last];
    if ((a.y() > point_m.y()) == (b.y() > point_m.y())) continue;
    const double x = a.x() + (b.x() - a.x()) * ((point_m.y() - a.y()) / (b.y() - a.y()));
    if (point_m.x() < x) is_inside = !is_inside;
  }
  return is_inside;
}

MapRegion rectangle_between(const Point2& low_m, const Point2& high_m) {
  return {{low_m, {high_m.x(), low_m.y()}, high_m, {low_m.x(), high_m.y()}}};
}

MapRegion in_frame(const Pose2& T_a_b, const MapRegion& region_b) {
  MapRegion region_a;
  region_a.corners_m.reserve(region_b.corners_m.size());
  for (const Point2& corner : region_b.corners_m) region_a.corners_m.push_back(T_a_b * corner);
  return region_a;
}

RegionBounds region_bounds(const MapRegion& region) {
  RegionBounds bounds{region.corners_m.front(), region.corners_m.front()};
  for (const Point2& corner : region.corners_m) {
    bounds.low_m = bounds.low_m.cwiseMin(corner);
    bounds.high_m = bounds.high_m.cwiseMax(corner);
  }
  return bounds;
}

std::uint64_t take_out_readings(const EndRules& rules, const ScanConfig& valid, const Pose2& T_map_base,
                                LaserScan& scan) {
  if (rules.erased.empty() && rules.kept.empty()) return 0;
  const double limit_m = range_limit_m(scan, valid.max_range_m);
  const bool moved = is_skewed(scan);
  std::uint64_t count = 0;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const auto range_m = static_cast<double>(scan.ranges_m[beam]);
    if (!(range_m >= valid.min_range_m && range_m < limit_m)) continue;  // false for NaN too
    const auto direction = beam_direction(scan, beam);
    const Pose2 T_base_laser = moved ? laser_at_beam(scan, beam) : scan.T_base_laser;
    const Point2 end_m = T_map_base * (T_base_laser * Point2(range_m * direction.cos, range_m * direction.sin));
    if (!is_taken_out(rules, end_m)) continue;
    scan.ranges_m[beam] = std::numeric_limits<float>::infinity();
    ++count;
  }
  return count;
}

OccupancyMap cropped(OccupancyMap map, const std::vector<MapRegion>& kept) {
  if (kept.empty()) return map;
  const CellBox box = cells_within(map.geometry, kept);
  if (box.empty()) {
    const GridGeometry& g = map.geometry;
    throw InputError(fmt::format("--crop leaves nothing of the map, which reaches from {:.2f},{:.2f} to {:.2f},{:.2f}",
                                 g.origin_x_m, g.origin_y_m, g.origin_x_m + g.width * g.resolution_m,
                                 g.origin_y_m + g.height * g.resolution_m));
  }
  OccupancyMap part;
  part.geometry = map.geometry;
  part.geometry.width = box.width();
  part.geometry.height = box.height();
  part.geometry.origin_x_m = origin_of_part(map.geometry.origin_x_m, map.geometry.resolution_m, box.min.x);
  part.geometry.origin_y_m = origin_of_part(map.geometry.origin_y_m, map.geometry.resolution_m, box.min.y);
  part.cells = CellStates(part.geometry.cell_count());
  std::size_t cell = 0;
  for (std::int32_t y = box.min.y; y < box.end.y; ++y) {
    for (std::int32_t x = box.min.x; x < box.end.x; ++x, ++cell) {
      const CellState state = map.at({x, y});
      if (state == CellState::kUnknown) continue;
      const Point2 centre_m = map.geometry.cell_centre({x, y});
      const auto has_it = [&centre_m](const MapRegion& region) { return region.contains(centre_m); };
      if (std::all_of(kept.begin(), kept.end(), has_it)) part.cells.set(cell, state);
    }
  }
  return part;
}

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kEditsVersion = 1;
constexpr std::size_t kMostEditsBytes = std::size_t{16} << 20U;
constexpr const char* kEditAgain = "; edit the run anew: gdtslam edit RUN -o DIR";
constexpr double kMostMapNumber = 1.0e6;                                            // metres and radians of a map
constexpr double kMostWorldNumber = 1.0e9;                                          // metres of a country's grid
constexpr std::array<std::string_view, 3> kDirections{"stated", "walls", "north"};  // in the order of FrameEdit::By

// Without the sign of a zero.
Json pose_json(const Pose2& T) { return {T.x_m + 0.0, T.y_m + 0.0, T.theta_rad + 0.0}; }
Json point_json(const Point2& p) { return {p.x(), p.y()}; }

struct StepWriter {
  Json operator()(const FrameEdit& edit) const {
    Json json{{"step", "frame"},
              {"direction_by", kDirections.at(static_cast<std::size_t>(edit.by))},
              {"origin", pose_json(edit.T_before_after)}};
    if (edit.by == FrameEdit::By::kWalls) json["walls_share"] = edit.walls_share;
    return json;
  }
  Json operator()(const EraseEdit& edit) const {
    Json corners = Json::array();
    for (const Point2& corner : edit.region.corners_m) corners.push_back(point_json(corner));
    return {{"step", "erase"}, {"polygon", std::move(corners)}};
  }
  Json operator()(const CropEdit& edit) const {
    return {{"step", "crop"}, {"low", point_json(edit.low_m)}, {"high", point_json(edit.high_m)}};
  }
  Json operator()(const GeoreferenceEdit& edit) const {
    Json points = Json::array();
    for (std::size_t k = 0; k < edit.points.size(); ++k) {
      points.push_back({{"map", point_json(edit.points[k].map_m)},
                        {"world", point_json(edit.points[k].world_m)},
                        {"residual_m", edit.fit.residuals_m.at(k)}});
    }
    return {{"step", "georeference"},
            {"points", std::move(points)},
            {"T_world_map", pose_json(edit.fit.T_world_map)},
            {"scale", edit.fit.scale},
            {"rms_m", edit.fit.rms_m}};
  }
  Json operator()(const WorldFileEdit& /*edit*/) const { return {{"step", "world-file"}}; }
};

/// Applies one step at a time.
struct PlanMaker {
  EditPlan plan;

  void operator()(const FrameEdit& edit) {
    if (edit.T_before_after == Pose2{}) return;
    const Pose2 T_after_before = inverse(edit.T_before_after);
    plan.T_edited_run = plan.has_other_frame ? T_after_before * plan.T_edited_run : T_after_before;
    plan.has_other_frame = true;
    for (std::vector<MapRegion>* regions : {&plan.erased, &plan.kept}) {
      for (MapRegion& region : *regions) region = in_frame(T_after_before, region);
    }
    if (plan.T_world_edited) plan.T_world_edited = *plan.T_world_edited * edit.T_before_after;
  }
  void operator()(const EraseEdit& edit) { plan.erased.push_back(edit.region); }
  void operator()(const CropEdit& edit) { plan.kept.push_back(rectangle_between(edit.low_m, edit.high_m)); }
  void operator()(const GeoreferenceEdit& edit) { plan.T_world_edited = edit.fit.T_world_map; }
  void operator()(const WorldFileEdit& /*edit*/) { plan.with_world_file = true; }
};

Point2 step_point(const ReportReader& step, const char* key, double most) {
  const std::vector<double> numbers = step.numbers(key, 2, most);
  return {numbers[0], numbers[1]};
}

Pose2 step_pose(const ReportReader& step, const char* key, double most) {
  const std::vector<double> numbers = step.numbers(key, 3, most);
  if (std::fabs(numbers[2]) > kMostMapNumber) step.fail(key, "has an angle that is none");
  return {numbers[0], numbers[1], numbers[2]};
}

FrameEdit frame_from(const ReportReader& step) {
  FrameEdit edit;
  const auto by = std::find(kDirections.begin(), kDirections.end(), step.text("direction_by"));
  if (by == kDirections.end()) step.fail("direction_by", "is none of stated, walls and north");
  edit.by = static_cast<FrameEdit::By>(by - kDirections.begin());
  edit.T_before_after = step_pose(step, "origin", kMostMapNumber);
  if (edit.by == FrameEdit::By::kWalls) edit.walls_share = step.number("walls_share");
  return edit;
}

EraseEdit erase_from(const ReportReader& step) {
  EraseEdit edit;
  for (const std::vector<double>& corner : step.rows("polygon", 2, kMostMapNumber)) {
    edit.region.corners_m.emplace_back(corner[0], corner[1]);
  }
  if (edit.region.corners_m.size() < 3) step.fail("polygon", "has fewer than 3 corners");
  return edit;
}

CropEdit crop_from(const ReportReader& step) {
  CropEdit edit{step_point(step, "low", kMostMapNumber), step_point(step, "high", kMostMapNumber)};
  if (!(edit.low_m.x() < edit.high_m.x() && edit.low_m.y() < edit.high_m.y())) {
    step.fail("high", "is not above 'low'");
  }
  return edit;
}

GeoreferenceEdit georeference_from(const ReportReader& step) {
  GeoreferenceEdit edit;
  for (const ReportReader& point : step.entries("points")) {
    edit.points.push_back({step_point(point, "map", kMostMapNumber), step_point(point, "world", kMostWorldNumber)});
    edit.fit.residuals_m.push_back(point.number("residual_m"));
  }
  edit.fit.T_world_map = step_pose(step, "T_world_map", kMostWorldNumber);
  edit.fit.scale = step.number("scale");
  edit.fit.rms_m = step.number("rms_m");
  return edit;
}

EditStep step_from(const ReportReader& step) {
  const std::string kind = step.text("step");
  if (kind == "frame") return frame_from(step);
  if (kind == "erase") return erase_from(step);
  if (kind == "crop") return crop_from(step);
  if (kind == "georeference") return georeference_from(step);
  if (kind != "world-file") step.fail("step", fmt::format("is {}, which this program does not know", in_quotes(kind)));
  return WorldFileEdit{};
}

}  // namespace

EditPlan combine_steps(const std::vector<EditStep>& steps, const EditPlan& earlier) {
  PlanMaker maker;
  maker.plan.T_world_edited = earlier.T_world_edited;
  maker.plan.with_world_file = earlier.with_world_file;
  for (const EditStep& step : steps) std::visit(maker, step);
  return maker.plan;
}

std::string edits_text(const RecordedEdits& edits, std::size_t readings) {
  const EditPlan plan = combine_steps(edits.steps);
  Json json{{"format", kEditsVersion},
            {"version", GDTSLAM_VERSION},
            {"run", edits.run},
            {"begins_at_s", edits.begins_at_s},
            {"T_edited_run", pose_json(plan.T_edited_run)}};
  if (plan.T_world_edited) json["T_world_edited"] = pose_json(*plan.T_world_edited);
  json["readings_taken_out"] = readings;
  json["steps"] = Json::array();
  for (const EditStep& step : edits.steps) json["steps"].push_back(std::visit(StepWriter{}, step));
  return json_text(json);
}

RecordedEdits parse_edits(std::string_view text, const std::string& name) {
  const ReportReader file(name, kEditAgain, parse_json(text, name, kEditAgain));
  if (file.whole("format") != kEditsVersion) {
    file.fail(fmt::format("has format {}, and this program reads format {}", file.whole("format"), kEditsVersion));
  }
  RecordedEdits edits{.run = file.text("run"), .begins_at_s = file.number("begins_at_s"), .steps = {}};
  for (const ReportReader& step : file.entries("steps")) edits.steps.push_back(step_from(step));
  return edits;
}

RecordedEdits read_edits(const std::string& file) {
  return parse_edits(read_all(*open_file_source(file), kMostEditsBytes, file), file);
}

}  // namespace gdtslam
