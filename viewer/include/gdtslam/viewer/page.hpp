// A self-contained HTML file: it opens offline in a browser, where one can turn the cloud, switch layers and colours,
// and play the linkage. Data are base64, 16 bytes of text per point: coordinates and time in 16 bits (error at most
// 1/131070 of the cloud's size), elevation, scan and distance in 8. Points that are not finite are skipped, as are
// outliers farther from the middle 99.8 % than its size; the page gives their number. Drawn by WebGL 2 with our own
// program. Frame: map, metres. Thread-safe; O(n log n) in the points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// Content of a page; null parts are left out.
struct PageInput {
  std::string title;
  std::string subtitle;
  const Cloud* cloud = nullptr;  ///< may be null, like all below; the caller thins it to a page's limit
  const std::vector<float>* distances_m = nullptr;  ///< distance of each point to a reference
  const Trajectory* trajectory = nullptr;
  /// Indices of the first poses of further drives, ascending. No line leads there, and time continues from the end of
  /// the previous drive. A cloud's times are not changed.
  std::vector<std::size_t> drives{};
  const OccupancyMap* map = nullptr;  ///< a picture on the floor
  const calib::SweepModel* linkage = nullptr;
  std::vector<std::pair<std::string, std::string>> facts;  ///< name and value for the panel: "Points", "2,612,034"
};

/// Throws InputError if there is nothing to show, if no point of the cloud is finite, for more than 2^24 points, and if
/// distances and points differ in number; ConfigError for a linkage that never closes.
std::string make_page(const PageInput& input);

}  // namespace gdtslam
