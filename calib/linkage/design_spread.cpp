#include "design_spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gdtslam::calib {

std::array<double, 4> shares_of(const FourBar& bars) {
  const double sum = bars.crank_m + bars.coupler_m + bars.rocker_m + bars.ground_m;
  return {bars.crank_m / sum, bars.coupler_m / sum, bars.rocker_m / sum, bars.ground_m / sum};
}

double distance_of_shapes(const FourBar& a, const FourBar& b) {
  const std::array<double, 4> of_a = shares_of(a);
  const std::array<double, 4> of_b = shares_of(b);
  double sum = 0.0;
  for (std::size_t k = 0; k < of_a.size(); ++k) sum += (of_a[k] - of_b[k]) * (of_a[k] - of_b[k]);
  return std::sqrt(sum);
}

std::vector<FourBar> spread_shapes(std::span<const FourBar> shapes, std::size_t count) {
  std::vector<FourBar> taken;
  if (shapes.empty()) return taken;
  std::vector<double> nearest(shapes.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (taken.size() < count && nearest[next] >= kSameShape) {
    taken.push_back(shapes[next]);
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      nearest[k] = std::min(nearest[k], distance_of_shapes(shapes[k], taken.back()));
    }
    next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
  }
  return taken;
}

}  // namespace gdtslam::calib
