// One HTML file that needs nothing else: opens offline in a browser, lets one turn the cloud, switch layers and
// colours, and play the linkage. Data lie in it as base64: positions in 16 bits a coordinate (at most 1/65535 of the
// cloud's size off), attributes in 8 bits. Drawn by WebGL 2 with a program of our own. Thread-safe; O(points).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

struct PageInput {
  std::string title;
  std::string subtitle;
  const Cloud* cloud = nullptr;  ///< may be null, as all below; thinned by the caller to what a page can hold
  const std::vector<float>* distances_m = nullptr;  ///< of each point to a reference
  const Trajectory* trajectory = nullptr;
  const OccupancyMap* map = nullptr;  ///< a picture on the floor
  const calib::SweepModel* linkage = nullptr;
  std::vector<std::pair<std::string, std::string>> facts;  ///< name and value, for the panel: "Points", "2,612,034"
};

/// Throws InputError where there is nothing to show.
std::string page_of(const PageInput& input);

}  // namespace gdtslam
