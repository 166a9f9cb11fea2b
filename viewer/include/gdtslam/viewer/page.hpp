// One HTML file that needs nothing else: opens offline in a browser, lets one turn the cloud, switch layers and
// colours, and play the linkage. Data lie in it as base64, 16 bytes of text a point: coordinates and time in 16 bits
// (at most 1/131070 of the cloud's size off), elevation, scan and distance in 8. Points that are not finite, and stray
// ones farther from the middle 99.8 % than that is large, are left out; the page says how many. Drawn by WebGL 2 with a
// program of our own. Frame: map, metres. Thread-safe; O(n log n) in the points.
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

/// Content of a page; null: not there.
struct PageInput {
  std::string title;
  std::string subtitle;
  const Cloud* cloud = nullptr;  ///< may be null, as all below; thinned by the caller to what a page can hold
  const std::vector<float>* distances_m = nullptr;  ///< distance of each point to a reference
  const Trajectory* trajectory = nullptr;
  /// Indices of the poses at which another drive begins, ascending. No line leads there, and its time continues from
  /// the end of the previous drive. A cloud's times stay as they are.
  std::vector<std::size_t> drives{};
  const OccupancyMap* map = nullptr;  ///< a picture on the floor
  const calib::SweepModel* linkage = nullptr;
  std::vector<std::pair<std::string, std::string>> facts;  ///< name and value, for the panel: "Points", "2,612,034"
};

/// Throws InputError if there is nothing to show, for a cloud of which no point is finite or which has more than 2^24
/// points, and for another number of distances than of points; ConfigError for a linkage that closes nowhere.
std::string make_page(const PageInput& input);

}  // namespace gdtslam
