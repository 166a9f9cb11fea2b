#include "dead_point.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"

namespace gdtslam::calib {

// The rocker's limits lie where crank and coupler are in line: stretched, the rocker's end is coupler + crank away
// from the crank's pivot, folded coupler - crank. Seen in the triangle of the two pivots and the rocker's end.
DeadPoint dead_point(const FourBar& bars, Assembly assembly, bool is_stretched) {
  const double reach = is_stretched ? bars.coupler_m + bars.crank_m : bars.coupler_m - bars.crank_m;
  const double x =
      (reach * reach + bars.ground_m * bars.ground_m - bars.rocker_m * bars.rocker_m) / (2.0 * bars.ground_m);
  const double height = std::sqrt(std::max(0.0, (reach - x) * (reach + x)));
  const double y = assembly == Assembly::kOpen ? height : -height;
  const double crank_rad = is_stretched ? atan2(y, x) : atan2(-y, -x);
  return {.crank_rad = crank_rad, .rocker_rad = atan2(y, x - bars.ground_m)};
}

}  // namespace gdtslam::calib
