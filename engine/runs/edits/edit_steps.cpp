#include "edit_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/io/byte_source.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/runs/folder/report_reader.hpp"

namespace gdtslam {
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

/// Takes one step after the other.
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

EditPlan plan_of(const std::vector<EditStep>& steps, const EditPlan& earlier) {
  PlanMaker maker;
  maker.plan.T_world_edited = earlier.T_world_edited;
  maker.plan.with_world_file = earlier.with_world_file;
  for (const EditStep& step : steps) std::visit(maker, step);
  return maker.plan;
}

std::string edits_text(const RecordedEdits& edits, std::size_t readings) {
  const EditPlan plan = plan_of(edits.steps);
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
