// Boxes of a cloud and their dimensions with uncertainty, as figure 12 measures them. Metres, frame of the cloud.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "gdtslam/cloud/plane.hpp"

namespace gdtslam {

struct Dimension {
  double value_m = 0.0;
  double sigma_m = 0.0;
  bool is_observed = false;  ///< both of its ends were seen
};

/// An upright box that stands on the floor (or on whatever its lower side is).
struct MeasuredBox {
  Point3 centre{0.0, 0.0, 0.0};
  double yaw_rad = 0.0;  ///< of the width's direction
  Dimension width;       ///< along the face that is seen best
  Dimension depth;
  Dimension height;
  std::uint32_t points = 0;
  double face_rms_m = 0.0;
};

struct BoxSearch {
  PlaneSearch planes;
  double max_size_m = 1.5;  ///< larger things are walls or furniture
  double min_size_m = 0.1;
  double min_face_points = 50;
};
/// By size of their best face, the widest first.
std::vector<MeasuredBox> find_boxes(std::span<const CloudPoint> cloud, const BoxSearch& search);

}  // namespace gdtslam
