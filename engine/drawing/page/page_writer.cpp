#include "page_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "calib/linkage/linkage_cycle.hpp"
#include "engine/core/base64.hpp"
#include "engine/core/elementary.hpp"
#include "engine/drawing/letters.hpp"
#include "gdtslam/core/angle.hpp"

/// The files of page/program, embedded in the library.
namespace gdtslam::page_text_parts {
std::string_view skeleton();  ///< page.html with {{name}} placeholders that page_text fills in
std::string_view style();
std::string_view style_hash();  ///< for the content security policy, like the program's
std::string_view program();     ///< all scripts concatenated
std::string_view program_hash();
}  // namespace gdtslam::page_text_parts

namespace gdtslam::page {
namespace {

namespace parts = gdtslam::page_text_parts;

std::string policy(std::string_view sources) {
  return fmt::format("default-src 'none'; script-src {}; style-src {}; base-uri 'none'; form-action 'none'; {}",
                     parts::program_hash(), parts::style_hash(), sources);
}

/// The table's row of a crank angle, with its fraction; always below kCrankSteps, even if an angle just below zero
/// rounds to a whole turn.
double step_at(double crank_rad) {
  const double turned = crank_rad / kTwoPi;
  return std::fmod((turned - std::floor(turned)) * kCrankSteps, kCrankSteps);
}

/// Start and end of the lift, if the linkage is a crank-rocker, and the step at which motion starts.
void describe_ends(const calib::LinkageCycle& cycle, Json& about) {
  const double first = step_at(cycle.begin().crank_rad);
  about["first"] = cycle.report() ? first : std::fmod(std::ceil(first), kCrankSteps);
  Json dead_points = Json::array();
  if (cycle.report()) {
    for (const calib::LinkagePosition* dead : {&cycle.begin(), &cycle.end()}) {
      dead_points.push_back({{"step", step_at(dead->crank_rad)}, {"elevation", wrap_angle(dead->elevation_rad)}});
    }
  }
  about["dead_points"] = std::move(dead_points);
}

Json json_place(const Point2& place) { return Json::array({place.x(), place.y()}); }

/// State of the cells under one pixel.
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

constexpr double kClockStep_s = 1.0;       // larger steps back mean that a clock was set
constexpr double kLongestGap_s = 86400.0;  // larger steps ahead mean that a clock was set, as at boot

/// The finite poses of a path. Times never step back: they continue at a new drive and at a clock that was set.
struct FinitePath {
  Trajectory poses;
  std::vector<std::size_t> drives;
  bool has_log_times = true;  ///< true if times differ from the log's only by jitter
};

FinitePath finite_path(const Trajectory& trajectory, std::span<const std::size_t> drives) {
  FinitePath path;
  double later_s = 0.0;
  auto next = drives.begin();
  for (std::size_t k = 0; k < trajectory.size(); ++k) {
    const auto& [stamp_s, T_map_base] = trajectory[k];
    if (!T_map_base.is_finite() || !std::isfinite(stamp_s)) continue;
    const auto begun = std::upper_bound(next, drives.end(), k);
    const bool is_other_drive = begun != std::exchange(next, begun) && !path.poses.empty();
    const double last_s = path.poses.empty() ? stamp_s : path.poses.back().stamp_s;
    const double passed_s = stamp_s + later_s - last_s;
    if (is_other_drive) path.drives.push_back(path.poses.size());
    if (is_other_drive || passed_s < -kClockStep_s || passed_s > kLongestGap_s) later_s = last_s - stamp_s;
    path.has_log_times = path.has_log_times && later_s == 0.0;
    path.poses.push_back({std::max(last_s, stamp_s + later_s), T_map_base});
  }
  return path;
}

}  // namespace

void add_element(PageData& data, std::string id, std::span<const std::uint8_t> bytes) {
  std::string text;
  append_base64(std::as_bytes(bytes), text);
  data.elements.emplace_back(std::move(id), std::move(text));
}

std::string json_text(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<' || c == '>' || c == '&') {
      text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      text += c;
    }
  }
  return text;
}

// In one pass, so that placeholders within untrusted text are not replaced.
std::string page_text(const PageData& data, std::string_view sources) {
  std::string_view skeleton = parts::skeleton();
  std::string out;
  while (true) {
    const std::size_t open = skeleton.find("{{");
    out += skeleton.substr(0, open);
    if (open == std::string_view::npos) return out;
    const std::size_t close = skeleton.find("}}", open);
    const std::string_view name = skeleton.substr(open + 2, close - open - 2);
    if (name == "title") out += markup_text(data.description.at("title").get_ref<const std::string&>());
    if (name == "policy") out += policy(sources);
    if (name == "style") out += parts::style();
    if (name == "data") out += json_text(data.description);
    if (name == "elements") {
      for (const auto& [id, text] : data.elements) {
        out.append("<script type=\"text/plain\" id=\"").append(id).append("\">").append(text).append("</script>\n");
      }
    }
    if (name == "program") out += parts::program();
    skeleton.remove_prefix(close + 2);
  }
}

void write_path(const Trajectory& trajectory, std::span<const std::size_t> drives, const Point2& origin,
                PageData& page) {
  const FinitePath path = finite_path(trajectory, drives);
  if (path.poses.empty()) return;
  const std::size_t count = std::min(path.poses.size(), kMostPoses);
  const double first_s = path.poses.front().stamp_s;
  ByteWriter bytes(16 * count);
  Json begins = Json::array();
  auto drive = path.drives.begin();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t index = count == 1 ? 0 : k * (path.poses.size() - 1) / (count - 1);
    const auto& [stamp_s, pose] = path.poses[index];
    bytes.f32(pose.x_m - origin.x());
    bytes.f32(pose.y_m - origin.y());
    bytes.f32(pose.theta_rad);
    bytes.f32(stamp_s - first_s);
    const auto begun = std::upper_bound(drive, path.drives.end(), index);
    if (begun != std::exchange(drive, begun)) begins.push_back(k);
  }
  add_element(page, "path", bytes.bytes());
  page.description["path"] = {
      {"count", count},
      {"drives", begins},
      {"length", path_length_m(path.poses, path.drives)},  // length of all poses, not only those in the page
      {"first", first_s},
      {"last", path.poses.back().stamp_s},
      {"log_times", path.has_log_times ? 1 : 0}};
}

void write_map(const OccupancyMap& map, PageData& page) {
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
  add_element(page, "map", bytes.bytes());
  page.description["map"] = {{"width", width},
                             {"height", height},
                             {"resolution", map.geometry.resolution_m * factor},
                             {"x", map.geometry.origin_x_m},
                             {"y", map.geometry.origin_y_m}};
}

void write_linkage(const calib::SweepModel& model, PageData& page) {
  const calib::LinkageCycle cycle(model);
  const calib::FourBar& bars = model.bars;
  const Point2 rocker_pivot = -calib::place_in_mount(model, Point2::Zero());
  const double farthest_m =
      std::max({bars.rocker_m, bars.crank_m + bars.coupler_m - bars.ground_m, 0.5 * (bars.crank_m + bars.ground_m)});
  const double beam_m = 1.15 * farthest_m + 0.35 * bars.rocker_m;
  const Point2 corner(bars.crank_m, bars.crank_m);
  Eigen::AlignedBox2d covered(-corner, corner);
  covered.extend(rocker_pivot);
  ByteWriter bytes(std::size_t{32} * kCrankSteps);
  for (int step = 0; step < kCrankSteps; ++step) {
    const auto position = calib::position_at(model, kTwoPi * step / kCrankSteps);
    if (!position) {
      for (int k = 0; k < 8; ++k) bytes.f32(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    for (const Point2& place : {position->joints[1], position->joints[2], position->middle}) {
      bytes.f32(rocker_pivot.x() + place.x());
      bytes.f32(rocker_pivot.y() + place.y());
      covered.extend(rocker_pivot + place);
    }
    bytes.f32(position->elevation_rad);
    bytes.f32(position->pose.transmission_rad);
    const SinCos<double> beam = sin_cos(position->elevation_rad);
    covered.extend(rocker_pivot + beam_m * Point2(beam.cos, beam.sin));
  }
  add_element(page, "linkage", bytes.bytes());
  Json about{{"name", model.name},
             {"steps", kCrankSteps},
             {"class", calib::class_name(cycle.grashof())},
             {"crank", bars.crank_m},
             {"coupler", bars.coupler_m},
             {"rocker", bars.rocker_m},
             {"ground", bars.ground_m},
             {"direction", model.encoder.direction},
             {"sign", model.elevation_sign},
             {"offset", model.elevation_offset_rad},
             {"height", model.mount.height_m},
             {"beam", beam_m},
             {"rocker_pivot", json_place(rocker_pivot)},
             {"least", json_place(covered.min())},
             {"most", json_place(covered.max())}};
  describe_ends(cycle, about);
  page.description["linkage"] = std::move(about);
}

}  // namespace gdtslam::page
