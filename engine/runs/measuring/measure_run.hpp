// Measures boxes and planes of a cloud as `gdtslam measure` does: finds where the scanner stood unless that is given,
// then boxes and planes. Thread-safe; cost: that of find_boxes() and find_planes().
#pragma once

#include <optional>
#include <span>
#include <string>

#include "gdtslam/core/cloud.hpp"
#include "measure_table.hpp"

namespace gdtslam {

struct MeasureJob {
  std::string cloud;  ///< the file, for the record
  bool boxes = true;
  bool planes = false;
  BoxSearch box_search{};  ///< without the viewpoint
  PlaneSearch plane_search{};
  bool finds_viewpoint = true;        ///< where none is given
  std::optional<Point3> viewpoint{};  ///< given
};

Measurement measure_cloud(const MeasureJob& job, std::span<const CloudPoint> cloud);

}  // namespace gdtslam
