#include "pose_filter.hpp"

#include <algorithm>
#include <cmath>

namespace gdtslam {
namespace {

constexpr double kMatchPointNoise_m = 0.02;
constexpr double kMatchIndependent = 400.0;  // independent points of a scan and of its map
constexpr double kMatchEnough = 100.0;       // with fewer points a scan has less information
constexpr double kMatchLeastShare = 0.01;
constexpr double kMatchLeastShape = 4.0e-9;  // information of a direction in which the scan shows nothing
constexpr double kMostMatchChi2 = 30.0;      // if the two are farther apart, one is wrong

}  // namespace

MatchInformation match_information(const KeptScan& scan) {
  const std::size_t points = scan.surface.size();
  const double count =
      kMatchIndependent * std::clamp(static_cast<double>(points) / kMatchEnough, kMatchLeastShare, 1.0);
  const auto [shape, believed] = shape_of_one(surface_shape(scan), points, kMatchLeastShape, feigned_shape(scan));
  const Matrix3 lone = lone_information(scan);
  return {.matrix = count / (kMatchPointNoise_m * kMatchPointNoise_m) * shape + lone,
          .believed = lone == Matrix3{} ? believed : Matrix3::identity(),
          .held = believed};
}

bool are_apart(const Pose2& T_map_a, const Pose2& T_map_b, const Matrix3& information) {
  return squared_norm(information, log_tangent(between(T_map_a, T_map_b))) >= kMostMatchChi2;
}

void PoseFilter::predict(const Pose2& T_map_predicted, const MotionNoise& noise) {
  const Matrix3 carried = adjoint_matrix(between(T_map_predicted, T_map_base_));
  const double m = noise.sigma_m * noise.sigma_m;
  covariance_ =
      carried * times_transposed(covariance_, carried) + Matrix3::diagonal(m, m, noise.sigma_rad * noise.sigma_rad);
  T_map_base_ = T_map_predicted;
}

MotionNoise PoseFilter::sigma() const { return {position_sigma(covariance_), std::sqrt(covariance_(2, 2))}; }

// Along a corridor a match slides, always to where the map is known. Its walls are seen under slightly wrong angles, so
// that the slide would count as a measurement across them: it is left out.
//
// The two differ in heading, so the match's information is first turned to the heading of the prediction, and the
// covariance of both to that of the result. With noisy wheels headings are 50 mrad apart, and the sine of that times
// the sideways difference would push each step forward, by half a per cent of the way.
PoseFilter::Fused PoseFilter::fused_with(const Pose2& T_map_matched, const MatchInformation& match) const {
  const Pose2 apart = between(T_map_base_, T_map_matched);
  const Matrix3 turn = adjoint_matrix(Pose2{0.0, 0.0, apart.theta_rad});
  const Matrix3 information = turn * times_transposed(match.matrix, turn);
  const Matrix3 believed = turn * times_transposed(match.believed, turn);
  const Tangent2 off = believed * Tangent2{apart.x_m, apart.y_m, apart.theta_rad};
  const Matrix3 covariance = inverse(inverse(covariance_) + information);
  const Tangent2 step = covariance * (information * off);
  const Matrix3 turn_back = adjoint_matrix(Pose2{0.0, 0.0, -step[2]});
  return {.T_map_base = T_map_base_ * Pose2{step[0], step[1], step[2]},
          .covariance = turn_back * times_transposed(covariance, turn_back),
          .is_possible = squared_norm(inverse(covariance_ + inverse(information)), off) < kMostMatchChi2};
}

void PoseFilter::take(const Pose2& T_map_base, const Matrix3& covariance) {
  T_map_base_ = T_map_base;
  covariance_ = covariance;
}

}  // namespace gdtslam
