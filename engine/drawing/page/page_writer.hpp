// HTML pages with a common program: the map of a run (gdtslam/viewer/page.hpp), a running drive (live) and an atlas
// (fleet). A page is one file: style, program, a description in JSON, and elements with base64 data. Path, map and
// linkage are layers beside the cloud: a description in JSON and an element with data each. Names from logs and files
// are untrusted. Thread-safe; O(bytes).
#pragma once

#include <nlohmann/json.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/grids.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam::page {

using Json = nlohmann::ordered_json;

/// Content of a page: "title" and "subtitle" of the description; the program (page/program) reads the rest.
struct PageData {
  Json description = Json::object();
  std::vector<std::pair<std::string, std::string>> elements{};  ///< identifier and bytes as base64
};

void add_element(PageData& data, std::string id, std::span<const std::uint8_t> bytes);

/// JSON in one line without < > and &, safe within a script element.
std::string json_text(const Json& json);

/// The whole page. It runs only its own program, checked by hash, and loads only what `sources` allows (part of a
/// content security policy): "img-src 'self'".
std::string page_text(const PageData& data, std::string_view sources);

/// Writes values in little-endian order on any host.
class ByteWriter {
 public:
  explicit ByteWriter(std::size_t expected = 0) { bytes_.reserve(expected); }
  void u8(std::uint8_t value) { bytes_.push_back(value); }
  void u16(std::uint16_t value) {
    bytes_.push_back(static_cast<std::uint8_t>(value & 0xFFU));
    bytes_.push_back(static_cast<std::uint8_t>(value >> 8U));
  }
  void f32(double value) {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
    u16(static_cast<std::uint16_t>(bits & 0xFFFFU));
    u16(static_cast<std::uint16_t>(bits >> 16U));
  }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Poses as four float32: x, y relative to `origin`, heading, time since the first pose. At most kMostPoses, evenly
/// spread with both ends. `drives`: as in PageInput; the description has the first pose of each drive that has one
/// here. Times never step back: if a clock stepped back by more than a second, or ahead by more than a day, they
/// continue as at a new drive. Then `log_times` of the description is 0, because the times differ from the log's and a
/// cloud's.
inline constexpr std::size_t kMostPoses = 50'000;
void write_path(const Trajectory& trajectory, std::span<const std::size_t> drives, const Point2& origin,
                PageData& page);

/// Cells as CellState in two bits, four to a byte, the first in the lowest bits. If a side has more than kMostMapSide,
/// several cells become one: occupied, free or unknown, in this order of precedence.
inline constexpr std::int32_t kMostMapSide = 4096;
void write_map(const OccupancyMap& map, PageData& page);

/// The linkage at kCrankSteps crank angles of calib/four_bar.hpp from 0 on (theta_input), eight float32 each: joints A
/// and B, the middle of the coupler (x forward, z up, metres, from the crank's pivot; turned so that elevation 0 is
/// level), elevation, transmission angle. NaN if the loop does not close. The description has the length of the laser's
/// line, the extent of all positions with both pivots, and the step at which motion starts: the begin of the lift.
inline constexpr int kCrankSteps = 720;
void write_linkage(const calib::SweepModel& model, PageData& page);

}  // namespace gdtslam::page
