#include "match_chain.hpp"

#include "engine/core/elementary.hpp"
#include "engine/mapping/wheels/pose_filter.hpp"

namespace gdtslam {
namespace {

constexpr double kAcrossAxis = 0.25;  // least squared cosine between a normal and the axis that its surface constrains

// The covariance of a translation in a frame turned by this angle.
Matrix3 turned(const Matrix3& covariance, double by_rad) {
  const Matrix3 turn = adjoint_matrix(Pose2{0.0, 0.0, -by_rad});
  return turn * times_transposed(covariance, turn);
}

}  // namespace

Matrix3 MatchChain::take(const Pose2& T_map_base, const KeptScan& known, const KnownSurfaces& surfaces, bool is_place) {
  const MatchInformation match = match_information(known);
  Matrix3 unseen = Matrix3::identity();
  unseen -= match.held;
  const Matrix3 own = unseen * times_transposed(inverse(match.matrix), unseen);
  const Matrix3 covariance = own + of_first_seen(T_map_base, known, surfaces);
  if (is_place) {
    place_ = next_;
    links_.clear();
    own_of_place_ = own;
    heading_of_place_rad_ = T_map_base.theta_rad;
  } else {
    links_.push_back({T_map_base.theta_rad, covariance});
  }
  ++next_;
  return covariance;
}

// Along each axis: the mean covariance of the keyframes that first saw the surfaces across it.
Matrix3 MatchChain::of_first_seen(const Pose2& T_map_base, const KeptScan& known, const KnownSurfaces& surfaces) const {
  const Matrix3 shape = surface_shape(known);
  const double angle = 0.5 * atan2(2.0 * shape(0, 1), shape(0, 0) - shape(1, 1));
  const auto [sin, cos] = sin_cos(angle);
  const Matrix3 of_place = turned(own_of_place_, T_map_base.theta_rad - heading_of_place_rad_);
  std::vector<Matrix3> of_links;
  for (const Since& link : links_) of_links.push_back(turned(link.covariance, T_map_base.theta_rad - link.heading_rad));
  Matrix3 sum;
  for (const Point2& axis : {Point2(cos, sin), Point2(-sin, cos)}) {
    const PointMotion in_map(T_map_base);
    const Tangent2 along{axis.x(), axis.y(), 0.0};
    double weights = 0.0;
    double variance = 0.0;
    for (const SurfacePoint& p : known.surface) {
      const double weight = square(p.normal().dot(axis));
      if (weight < kAcrossAxis) continue;
      const std::size_t first = surfaces.first_seen(in_map(p.point()));
      weights += weight;
      if (first == place_) continue;
      variance += weight * squared_norm(first < place_ ? of_place : of_links[first - place_ - 1], along);
    }
    if (weights > 0.0) sum += variance / weights * outer(along, along);
  }
  return sum;
}

}  // namespace gdtslam
