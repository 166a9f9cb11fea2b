#include "path_noise.hpp"

#include <algorithm>
#include <cmath>

namespace gdtslam {
namespace {

constexpr double kGuessCounts = 4.0;     // number of measurements that the configuration counts as
constexpr double kFixGuess_m = 0.004;    // standard deviation of one fix, first guess
constexpr double kFixRadPerMetre = 0.3;  // its heading, as for the keyframes of the back end
constexpr double kLeastSquare = 1.0e-10;

double trace_of_product(const Matrix3& a, const Matrix3& b) {
  double trace = 0.0;
  for (int i = 0; i < 3; ++i) trace += a(i, 0) * b(0, i) + a(i, 1) * b(1, i) + a(i, 2) * b(2, i);
  return trace;
}

/// A residual and its covariance by the components.
struct PathResidual {
  Tangent2 off;
  Matrix3 weight;  ///< inverse of the covariance
  Tangent2 weighted;
  double trust = 1.0;  ///< weight by Student's t
};

PathResidual path_residual(const Tangent2& off, const Matrix3& covariance) {
  PathResidual residual{off, inverse(covariance), {}, 1.0};
  residual.weighted = residual.weight * off;
  residual.trust = student_weight(dot(off, residual.weighted));
  return residual;
}

// One step of the estimation of variance components: the squares and the degrees of freedom of this component.
void update(const PathResidual& residual, const Matrix3& shape, VarianceComponent& component) {
  const double now = component.value();
  component.squares += residual.trust * now * now * squared_norm(shape, residual.weighted) + kLeastSquare;
  component.count += now * trace_of_product(residual.weight, shape);
}

Matrix3 shape_of_fix() { return Matrix3::diagonal(1.0, 1.0, square(kFixRadPerMetre)); }

}  // namespace

PathNoise::PathNoise(const SmootherConfig& config) : config_(config) {
  const auto guess = [](double variance) { return VarianceComponent{kGuessCounts * variance, kGuessCounts}; };
  way_ = guess(square(config.odometry_m_per_sqrt_m));
  turn_ = guess(square(config.odometry_rad_per_sqrt_rad));
  fix_ = guess(2.0 * square(kFixGuess_m));
  points_ = guess(1.0);
}

// A turn at a place moves the path after it: the column of the adjoint that belongs to theta.
PathNoise::Growth PathNoise::growth(const PoseFix& from, const PoseFix& to, std::span<const PoseFix> nodes) {
  Growth growth;
  const PoseFix* last = &from;
  const auto step_to = [&](const PoseFix& next) {
    const Pose2 step = between(last->T_odom_base, next.T_odom_base);
    const Pose2 T_end_here = between(to.T_odom_base, next.T_odom_base);
    const double way_m = translation_length(step);
    const Tangent2 lever{T_end_here.y_m, -T_end_here.x_m, 1.0};
    growth.way_m += way_m;
    growth.about += (kTurnsPerMetre * way_m + std::fabs(step.theta_rad)) * outer(lever, lever);
    last = &next;
  };
  for (const PoseFix& node : nodes) step_to(node);
  step_to(to);
  return growth;
}

Matrix3 PathNoise::covariance(const Growth& growth) const {
  return way_.value() * Matrix3::diagonal(growth.way_m, growth.way_m, 0.0) + turn_.value() * growth.about +
         fix_.value() * shape_of_fix();
}

void PathNoise::take_closing(const PoseFix& from, const PoseFix& to, std::span<const PoseFix> nodes) {
  const Growth grown = growth(from, to, nodes);
  if (!(grown.about(2, 2) > 0.0)) return;
  const Pose2 by_wheels = between(from.T_odom_base, to.T_odom_base);
  const Tangent2 off = log_tangent(between(by_wheels, between(from.T_map_base, to.T_map_base)));
  const PathResidual residual = path_residual(off, covariance(grown));
  update(residual, Matrix3::diagonal(grown.way_m, grown.way_m, 0.0), way_);
  update(residual, grown.about, turn_);
  update(residual, shape_of_fix(), fix_);
}

// Half way both fixes determine the pose.
void PathNoise::take_view(const PoseFix& from, const PoseFix& to, std::span<const PoseFix> nodes, std::size_t at,
                          const PointsView& view) {
  const Eigen3 eigen = eigen_of_symmetric(view.information);
  if (!(std::min({eigen.values[0], eigen.values[1], eigen.values[2]}) > kLeastViewInformation)) return;
  const Matrix3 ahead = covariance(growth(from, nodes[at], nodes.first(at)));
  std::vector<PoseFix> back(nodes.rbegin(), nodes.rend() - static_cast<std::ptrdiff_t>(at) - 1);
  const Matrix3 behind = covariance(growth(to, nodes[at], back));
  const Matrix3 of_path = inverse(inverse(ahead) + inverse(behind));
  const Matrix3 of_points = inverse(view.information);
  const PathResidual residual = path_residual(of_points * view.away, of_path + points_.value() * of_points);
  update(residual, of_points, points_);
}

SmootherConfig PathNoise::found() const {
  SmootherConfig config = config_;
  config.odometry_m_per_sqrt_m = std::sqrt(way_.value());
  config.odometry_rad_per_sqrt_rad = std::sqrt(turn_.value());
  config.point_sigma_m *= std::sqrt(points_.value() * std::max(1.0, config_.same_view_m / config_.spacing_m));
  return config;
}

}  // namespace gdtslam
