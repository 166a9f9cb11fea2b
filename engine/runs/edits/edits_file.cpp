#include "edits_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/io/byte_source.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kEditsVersion = 1;
constexpr std::size_t kMostEditsBytes = std::size_t{16} << 20U;
constexpr const char* kEditAgain = "; edit the run anew: gdtslam edit RUN -o ";
constexpr double kMostMapNumber = 1.0e6;                                       // metres and radians of a map
constexpr double kMostWorldNumber = 1.0e9;                                     // metres of a country's grid
constexpr std::array<const char*, 3> kDirections{"stated", "walls", "north"};  // in the order of FrameEdit::By

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

/// An object of the file, and how messages name it.
class EditsReader {
 public:
  EditsReader(const Json& json, std::string file, std::string place)
      : json_(json), file_(std::move(file)), place_(std::move(place)) {
    if (!json.is_object()) fail("is no object");
  }
  [[nodiscard]] const Json& at(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) fail(fmt::format("has no '{}'", key));
    return *found;
  }
  [[nodiscard]] double number(const char* key, double most) const { return number_of(at(key), key, most); }
  [[nodiscard]] std::string text(const char* key) const {
    if (!at(key).is_string()) fail(fmt::format("has a '{}' that is no text", key));
    return at(key).get<std::string>();
  }
  [[nodiscard]] Point2 point(const char* key, double most) const { return point_of(at(key), key, most); }
  [[nodiscard]] Point2 point_of(const Json& value, const char* key, double most) const {
    expect_numbers(value, key, 2);
    return {number_of(value[0], key, most), number_of(value[1], key, most)};
  }
  [[nodiscard]] Pose2 pose(const char* key, double most) const {
    const Json& value = at(key);
    expect_numbers(value, key, 3);
    return {number_of(value[0], key, most), number_of(value[1], key, most), number_of(value[2], key, kMostMapNumber)};
  }
  [[nodiscard]] const Json& list(const char* key, std::size_t least) const {
    const Json& value = at(key);
    if (!value.is_array() || value.size() < least) {
      fail(fmt::format("has a '{}' that is no list of {} or more", key, least));
    }
    return value;
  }
  [[nodiscard]] EditsReader within(const Json& json, const std::string& place) const { return {json, file_, place}; }
  [[noreturn]] void fail(const std::string& fault) const {
    throw InputError({file_, 0}, place_ + fault + kEditAgain + "DIR");
  }

 private:
  void expect_numbers(const Json& value, const char* key, std::size_t count) const {
    if (!value.is_array() || value.size() != count) fail(fmt::format("has a '{}' that is not {} numbers", key, count));
  }
  [[nodiscard]] double number_of(const Json& value, const char* key, double most) const {
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!(std::fabs(number) <= most)) {  // true for NaN too
      fail(fmt::format("has a '{}' that is no number from {:g} to {:g}", key, -most, most));
    }
    return number;
  }

  const Json& json_;
  std::string file_;
  std::string place_;  // with a blank at its end
};

FrameEdit frame_from(const EditsReader& step) {
  FrameEdit edit;
  const std::string by = step.text("direction_by");
  std::size_t k = 0;
  while (k < kDirections.size() && by != kDirections.at(k)) ++k;
  if (k == kDirections.size()) step.fail("has a 'direction_by' that is none of stated, walls and north");
  edit.by = static_cast<FrameEdit::By>(k);
  edit.T_before_after = step.pose("origin", kMostMapNumber);
  if (edit.by == FrameEdit::By::kWalls) edit.walls_share = step.number("walls_share", 1.0);
  return edit;
}

EraseEdit erase_from(const EditsReader& step) {
  EraseEdit edit;
  for (const Json& corner : step.list("polygon", 3)) {
    edit.region.corners_m.push_back(step.point_of(corner, "polygon", kMostMapNumber));
  }
  return edit;
}

CropEdit crop_from(const EditsReader& step) {
  CropEdit edit{step.point("low", kMostMapNumber), step.point("high", kMostMapNumber)};
  if (!(edit.low_m.x() < edit.high_m.x() && edit.low_m.y() < edit.high_m.y())) {
    step.fail("has a 'high' that is not above its 'low'");
  }
  return edit;
}

GeoreferenceEdit georeference_from(const EditsReader& step, const std::string& place) {
  GeoreferenceEdit edit;
  for (const Json& entry : step.list("points", 2)) {
    const EditsReader point = step.within(entry, place + "(a point of it) ");
    edit.points.push_back({point.point("map", kMostMapNumber), point.point("world", kMostWorldNumber)});
    edit.fit.residuals_m.push_back(point.number("residual_m", kMostWorldNumber));
  }
  edit.fit.T_world_map = step.pose("T_world_map", kMostWorldNumber);
  edit.fit.scale = step.number("scale", kMostWorldNumber);
  edit.fit.rms_m = step.number("rms_m", kMostWorldNumber);
  return edit;
}

EditStep step_from(const EditsReader& step, const std::string& place) {
  const std::string kind = step.text("step");
  if (kind == "frame") return frame_from(step);
  if (kind == "erase") return erase_from(step);
  if (kind == "crop") return crop_from(step);
  if (kind == "georeference") return georeference_from(step, place);
  if (kind == "world-file") return WorldFileEdit{};
  step.fail(fmt::format("is {}, which this program does not know", in_quotes(kind)));
}

}  // namespace

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
  const Json json = parse_json(text, name, std::string(kEditAgain) + "DIR");
  const EditsReader file(json, name, "");
  if (!file.at("format").is_number_integer() || file.at("format") != kEditsVersion) {
    file.fail(fmt::format("is not of format {}, which this program reads", kEditsVersion));
  }
  RecordedEdits edits{.run = file.text("run"), .begins_at_s = file.number("begins_at_s", 1.0e18), .steps = {}};
  const Json& steps = file.list("steps", 1);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const std::string place = fmt::format("step {} ", k + 1);
    edits.steps.push_back(step_from(file.within(steps[k], place), place));
  }
  return edits;
}

RecordedEdits read_edits(const std::string& file) {
  return parse_edits(read_all(*open_file_source(file), kMostEditsBytes, file), file);
}

}  // namespace gdtslam
