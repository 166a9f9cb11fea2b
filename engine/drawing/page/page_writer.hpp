// HTML pages of one program: the map of a run (gdtslam/viewer/page.hpp), a drive while it lasts (live) and an atlas
// (fleet). A page is one file: style, program, a description in JSON, and elements with bytes as base64. Path, map and
// linkage are layers beside the cloud, each a description in JSON and an element with bytes. Names come from logs and
// files of others, so none is trusted. Thread-safe; O(bytes).
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

/// Content of a page: "title" and "subtitle" in the description; the program (page/program) reads the rest of it.
struct PageData {
  Json description = Json::object();
  std::vector<std::pair<std::string, std::string>> elements{};  ///< identifier and bytes as base64
};

void add_element(PageData& data, std::string id, std::span<const std::uint8_t> bytes);

/// The text in one line, without < > and &, so that it is safe within a script element.
std::string json_text(const Json& json);

/// The whole page. It runs its own program only, told by its hash, and takes only what `sources` allows, a part of a
/// content security policy: "img-src 'self'".
std::string page_text(const PageData& data, std::string_view sources);

/// Little-endian values one after the other, whatever the host.
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

/// Poses as four float32: x, y relative to `origin`, heading, time since the first pose. At most kMostPoses, spread
/// evenly, both ends among them. `drives`: as in PageInput; the description names the first pose of each that has one
/// here. Times never step back: where a clock did by more than a second, or leapt ahead by more than a day, they go
/// on as from drive to drive. `log_times` of the description is 0 where they are not those of the log, which a cloud
/// has.
inline constexpr std::size_t kMostPoses = 50'000;
void write_path(const Trajectory& trajectory, std::span<const std::size_t> drives, const Point2& origin,
                PageData& page);

/// Cells as CellState in two bits, four to a byte, the first in the lowest bits; several cells become one where a side
/// has more than kMostMapSide, the first of occupied, free, unknown that is among them.
inline constexpr std::int32_t kMostMapSide = 4096;
void write_map(const OccupancyMap& map, PageData& page);

/// The linkage at kCrankSteps crank angles of calib/four_bar.hpp from 0 on (theta_input), eight float32 each: joints A
/// and B, the middle of the coupler (x forward, z up, metres, from the crank's pivot; turned so that elevation 0 is
/// level), elevation, transmission angle. Not a number where the loop does not close. The description has how long the
/// laser's line is drawn, what all positions together cover, both pivots included, and the step at which motion starts:
/// the begin of the lift.
inline constexpr int kCrankSteps = 720;
void write_linkage(const calib::SweepModel& model, PageData& page);

}  // namespace gdtslam::page
