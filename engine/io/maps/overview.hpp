// The picture that says at a glance what a run made: map, trajectory coloured by time from start to end, doubtful
// scans, keyframes, scale bar and legend. Drawn in software: no display, no GL, no font file. North (map y) is up.
// Thread-safe; O(pixels + poses), about 20 MB for the usual size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "png.hpp"

namespace gdtslam {

struct OverviewInput {
  const OccupancyMap& map;
  const Trajectory& trajectory;
  std::vector<std::size_t> doubtful{};   ///< indices into the trajectory
  std::vector<std::size_t> keyframes{};  ///< likewise; none are drawn when empty
  std::string title{};                   ///< one line, ASCII; other characters become boxes
  std::string caption{};                 ///< a second, smaller line
};

/// Pixels of the longer side of the map in the picture.
inline constexpr std::uint32_t kOverviewSide = 1600;

/// RGB, rows from the top.
struct RgbImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> pixels;
  [[nodiscard]] ImageView view() const { return {width, height, PixelFormat::kRgb8, std::as_bytes(std::span(pixels))}; }
};

/// Where the map lies in the picture.
struct OverviewFrame {
  double x_m = 0.0;  ///< map coordinates of the upper left corner of the map in the picture
  double y_m = 0.0;
  double m_per_pixel = 1.0;
  double left_px = 0.0;  ///< of that corner
  double top_px = 0.0;
  double width_px = 0.0;
  double height_px = 0.0;
};

/// What draw_overview lays out for this input.
OverviewFrame overview_frame(const OverviewInput& input);
RgbImage draw_overview(const OverviewInput& input);
/// Atomic PNG. Throws FileError.
void write_overview(const std::string& path, const OverviewInput& input);

}  // namespace gdtslam
