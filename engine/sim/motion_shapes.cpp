#include "motion_shapes.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"

namespace gdtslam::sim {

SmoothTurn::SmoothTurn(double angle_rad, double cut_m) : angle_rad_(angle_rad) {
  at_node_[0] = {0.0, 0.0};
  for (int i = 0; i < kNodes; ++i) {
    const auto node = static_cast<std::size_t>(i);
    at_node_[node + 1] =
        at_node_[node] + integrated(static_cast<double>(i) / kNodes, static_cast<double>(i + 1) / kNodes);
  }
  // By symmetry both tangents are equally long: end.x = tangent * (1 + cos angle).
  const double unit_tangent = at_node_[kNodes].x() / (1.0 + sin_cos(angle_rad).cos);
  length_m_ = cut_m / unit_tangent;
}

double SmoothTurn::heading_at(double share) const { return angle_rad_ * share * share * (3.0 - 2.0 * share); }

double SmoothTurn::curvature_at(double share) const { return 6.0 * angle_rad_ * share * (1.0 - share) / length_m_; }

Point2 SmoothTurn::position_at(double share) const {
  const double inside = std::clamp(share, 0.0, 1.0);
  const int node = std::min(static_cast<int>(inside * kNodes), kNodes - 1);
  return length_m_ *
         (at_node_[static_cast<std::size_t>(node)] + integrated(static_cast<double>(node) / kNodes, inside));
}

Point2 SmoothTurn::integrated(double from_share, double to_share) const {
  // Five nodes and weights on [-1, 1] (Abramowitz and Stegun, table 25.4).
  constexpr std::array<double, 5> kAt{-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                                      0.9061798459386640};
  constexpr std::array<double, 5> kWeight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                          0.4786286704993665, 0.2369268850561891};
  const double half = 0.5 * (to_share - from_share);
  const double middle = 0.5 * (to_share + from_share);
  Point2 sum{0.0, 0.0};
  for (std::size_t i = 0; i < kAt.size(); ++i) {
    const SinCos<double> heading = sin_cos(heading_at(middle + half * kAt[i]));
    sum += kWeight[i] * half * Point2(heading.cos, heading.sin);
  }
  return sum;
}

}  // namespace gdtslam::sim
