#include "page_layers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/base64.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "page_bytes.hpp"
#include "viewer/scene/cloud/cloud_colours.hpp"

namespace gdtslam::page {
namespace {

/// From the linkage's own frame to the one in which it is drawn: turned by the elevation's offset, mirrored where the
/// elevation falls with the rocker's angle.
struct DrawnFrame {
  SinCos<double> turn;
  double sign;
  explicit DrawnFrame(const calib::SweepModel& model)
      : turn(sin_cos(model.elevation_offset_rad)), sign(model.elevation_sign) {}
  [[nodiscard]] Point2 of(const Point2& p) const {
    const double y = sign * p.y();
    return {turn.cos * p.x() - turn.sin * y, turn.sin * p.x() + turn.cos * y};
  }
};

Point2 at_angle(double length, double angle_rad) {
  const SinCos<double> s = sin_cos(angle_rad);
  return {length * s.cos, length * s.sin};
}

double crank_at(int step) { return kTwoPi * step / kCrankSteps; }

void append_linkage_step(const calib::SweepModel& model, const DrawnFrame& frame, double crank_rad, ByteWriter& bytes) {
  const auto pose = calib::solve(model.bars, model.assembly, crank_rad);
  const auto middle = calib::coupler_point(model.bars, model.assembly, crank_rad, 0.5 * model.bars.coupler_m, 0.0);
  const auto elevation = calib::elevation_rad(model, crank_rad);
  const Point2 a = frame.of(at_angle(model.bars.crank_m, crank_rad));
  bytes.f32(a.x());
  bytes.f32(a.y());
  if (!pose || !middle || !elevation) {
    for (int k = 0; k < 6; ++k) bytes.f32(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  const Point2 rocker_end = Point2(model.bars.ground_m, 0.0) + at_angle(model.bars.rocker_m, pose->rocker_rad);
  for (const Point2& p : {frame.of(rocker_end), frame.of(*middle)}) {
    bytes.f32(p.x());
    bytes.f32(p.y());
  }
  bytes.f32(*elevation);
  bytes.f32(pose->transmission_rad);
}

/// Dead points as steps of the table; none for a linkage that is no crank-rocker.
void write_dead_points(const calib::SweepModel& model, JsonWriter& json) {
  json.open("dead_points", '[');
  if (calib::grashof_class(model.bars) == calib::GrashofClass::kCrankRocker) {
    const calib::CrankRockerReport report = calib::analyse(model.bars, model.assembly);
    for (const calib::DeadPoint& dead : {report.lowest, report.highest}) {
      const double turned = dead.crank_rad / kTwoPi;
      const double elevation = wrap_angle(model.elevation_sign * dead.rocker_rad + model.elevation_offset_rad);
      json.open("", '{').number("step", (turned - std::floor(turned)) * kCrankSteps);
      json.number("elevation", elevation).close();
    }
  }
  json.close();
}

/// Of the cells that one pixel stands for.
CellState shown_state(const OccupancyMap& map, std::int32_t x, std::int32_t y, std::int32_t factor) {
  CellState shown = CellState::kUnknown;
  for (std::int32_t cy = y * factor; cy < std::min((y + 1) * factor, map.geometry.height); ++cy) {
    for (std::int32_t cx = x * factor; cx < std::min((x + 1) * factor, map.geometry.width); ++cx) {
      shown = std::max(shown, map.at({cx, cy}));
    }
  }
  return shown;
}
static_assert(CellState::kUnknown < CellState::kFree && CellState::kFree < CellState::kOccupied);

}  // namespace

void write_path(const Trajectory& trajectory, const Point3& origin, JsonWriter& json, std::string& elements) {
  std::vector<const StampedPose*> poses;
  for (const StampedPose& pose : trajectory) {
    if (pose.T_map_base.is_finite() && std::isfinite(pose.stamp_s)) poses.push_back(&pose);
  }
  if (poses.empty()) return;
  const std::size_t count = std::min(poses.size(), kMostPoses);
  const auto shown = [&](std::size_t k) { return poses[count == 1 ? 0 : k * (poses.size() - 1) / (count - 1)]; };
  const double first_s = poses.front()->stamp_s;
  ByteWriter bytes(16 * count);
  double length_m = 0.0;  // of all poses, whatever the page holds of them
  for (std::size_t k = 1; k < poses.size(); ++k) {
    length_m += (poses[k]->T_map_base.translation() - poses[k - 1]->T_map_base.translation()).norm();
  }
  for (std::size_t k = 0; k < count; ++k) {
    const Pose2& pose = shown(k)->T_map_base;
    bytes.f32(pose.x_m - origin.x());
    bytes.f32(pose.y_m - origin.y());
    bytes.f32(pose.theta_rad);
    bytes.f32(shown(k)->stamp_s - first_s);
  }
  append_bytes_element("path", bytes.bytes(), elements);
  json.open("path", '{').number("count", static_cast<double>(count)).number("length", length_m);
  json.number("first", first_s).number("last", poses.back()->stamp_s).close();
}

void write_map(const OccupancyMap& map, JsonWriter& json, std::string& elements) {
  const std::int32_t side = std::max(map.geometry.width, map.geometry.height);
  if (side <= 0) return;
  const std::int32_t factor = (side + kMostMapSide - 1) / kMostMapSide;
  const std::int32_t width = (map.geometry.width + factor - 1) / factor;
  const std::int32_t height = (map.geometry.height + factor - 1) / factor;
  ByteWriter bytes((static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 3) / 4);
  unsigned filled = 0;
  unsigned byte = 0;
  for (std::int32_t y = 0; y < height; ++y) {
    for (std::int32_t x = 0; x < width; ++x) {
      byte |= static_cast<unsigned>(shown_state(map, x, y, factor)) << 2U * filled;
      if (++filled == 4) {
        bytes.u8(static_cast<std::uint8_t>(byte));
        filled = 0;
        byte = 0;
      }
    }
  }
  if (filled > 0) bytes.u8(static_cast<std::uint8_t>(byte));
  append_bytes_element("map", bytes.bytes(), elements);
  json.open("map", '{').number("width", width).number("height", height);
  json.number("resolution", map.geometry.resolution_m * factor);
  json.number("x", map.geometry.origin_x_m).number("y", map.geometry.origin_y_m).close();
}

void write_linkage(const calib::SweepModel& model, JsonWriter& json, std::string& elements) {
  const std::vector<calib::CrankRange> ranges = calib::crank_ranges(model.bars);
  if (ranges.empty()) throw ConfigError("the loop closes at no crank angle, so a page cannot show the linkage");
  const DrawnFrame frame(model);
  ByteWriter bytes(std::size_t{32} * kCrankSteps);
  for (int step = 0; step < kCrankSteps; ++step) {
    append_linkage_step(model, frame, crank_at(step), bytes);
  }
  append_bytes_element("linkage", bytes.bytes(), elements);
  const Point2 rocker_pivot = frame.of({model.bars.ground_m, 0.0});
  json.open("linkage", '{').text("name", model.name).number("steps", kCrankSteps);
  json.text("class", calib::class_name(calib::grashof_class(model.bars)));
  json.number("crank", model.bars.crank_m).number("coupler", model.bars.coupler_m);
  json.number("rocker", model.bars.rocker_m).number("ground", model.bars.ground_m);
  json.number("direction", model.encoder.direction);
  json.number("sign", model.elevation_sign).number("offset", model.elevation_offset_rad);
  json.number("height", model.mount.height_m);
  json.open("rocker_pivot", '[').number("", rocker_pivot.x()).number("", rocker_pivot.y()).close();
  write_dead_points(model, json);
  json.close();
}

void write_colour_maps(JsonWriter& json) {
  json.open("colour_maps", '[');
  for (const ColourMap& map : colour_maps()) {
    std::vector<std::uint8_t> bytes;
    for (const Colour& colour : map.table()) bytes.insert(bytes.end(), {colour.red, colour.green, colour.blue});
    std::string colours;
    append_base64(std::as_bytes(std::span(bytes)), colours);
    json.open("", '{').text("name", map.name()).text("doc", map.doc()).text("colours", colours).close();
  }
  json.close();
  json.open("default_maps", '{');
  const std::pair<std::string_view, CloudColour> quantities[] = {{"height", CloudColour::kHeight},
                                                                 {"elevation", CloudColour::kElevation},
                                                                 {"time", CloudColour::kTime},
                                                                 {"scan", CloudColour::kScan},
                                                                 {"distance", CloudColour::kDistance}};
  for (const bool is_dark : {true, false}) {
    json.open(is_dark ? "dark" : "light", '{');
    for (const auto& [key, colour] : quantities) {
      CloudLook look;
      look.colour = colour;
      look.is_dark = is_dark;
      json.text(key, colour_scale(look, CloudValues(colour, {}, {}), {}).colour_map);
    }
    json.close();
  }
  json.close();
}

}  // namespace gdtslam::page
