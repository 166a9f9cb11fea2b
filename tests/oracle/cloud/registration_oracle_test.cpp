// The first step of register_clouds against loops over all pairs of points.
#include <Eigen/Eigenvalues>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/cloud/registration.hpp"
#include "support/cloud_scenes.hpp"

namespace gdtslam {
namespace {

Point3 at(const CloudPoint& point) {
  return {static_cast<double>(point.x_m), static_cast<double>(point.y_m), static_cast<double>(point.z_m)};
}

// Direction of least scatter of the points closest to a point, by sorting all; nothing where they are no plane.
std::optional<Point3> brute_normal(const Cloud& cloud, const Point3& point, std::size_t count) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < cloud.size(); ++k) order.emplace_back((at(cloud[k]) - point).squaredNorm(), k);
  std::sort(order.begin(), order.end());
  Eigen::MatrixXd near(3, static_cast<Eigen::Index>(count));
  for (std::size_t k = 0; k < count; ++k) near.col(static_cast<Eigen::Index>(k)) = at(cloud[order[k].second]);
  const Eigen::MatrixXd centred = near.colwise() - near.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(centred * centred.transpose());
  if (!(solver.eigenvalues()[0] < 0.09 * solver.eigenvalues()[1])) return std::nullopt;
  return solver.eigenvectors().col(0);
}

// Distance of each source point to the plane at its nearest target point.
double brute_rms(const Cloud& source, const Cloud& target, const RegistrationOptions& options, std::size_t& pairs) {
  double sum = 0.0;
  pairs = 0;
  for (const CloudPoint& from : source) {
    double least = std::numeric_limits<double>::infinity();
    Point3 nearest = Point3::Zero();
    for (const CloudPoint& to : target) {
      const double squared = (at(to) - at(from)).squaredNorm();
      if (squared < least) {
        least = squared;
        nearest = at(to);
      }
    }
    if (least > options.max_distance_m * options.max_distance_m) continue;
    const std::optional<Point3> normal = brute_normal(target, nearest, options.neighbours);
    if (!normal) continue;
    const double off_m = normal->dot(at(from) - nearest);
    sum += off_m * off_m;
    ++pairs;
  }
  return std::sqrt(sum / static_cast<double>(pairs));
}

TEST(RegisterCloudsOracle, TheFirstPairsAreTheNearestAndTheirDistanceIsToThePlane) {
  Random random(1);
  Cloud source;
  Cloud target;
  // No noise, and points of a wall keep from the others: every neighbourhood is flat.
  for (double wall = 0.0; wall < 3.0; wall += 1.0) {
    const test::Rectangle at_wall{{5.0 * wall, 0.0, 0.0}, {0.3 * wall, 2.0, 0.0}, {0.0, 0.0, 2.0}};
    test::strew(target, at_wall, 400, 0.0, random);
    test::strew(source, at_wall, 150, 0.02, random);
  }
  RegistrationOptions options;
  options.max_iterations = 1;
  std::size_t pairs = 0;
  const double expected_m = brute_rms(source, target, options, pairs);
  const RegistrationResult found = register_clouds(source, target, options);
  EXPECT_EQ(found.pairs, pairs);
  EXPECT_NEAR(found.rms_before_m, expected_m, 1e-9);
}

// The information is the sum of J^T J with J the derivative of a residual by a motion, here by differences.
TEST(RegisterCloudsOracle, TheInformationIsThatOfNumericDerivatives) {
  Random random(2);
  Cloud cloud;
  for (const test::Rectangle& side : test::room({4.0, 3.0, 2.5})) test::strew(cloud, side, 300, 0.0, random);
  RegistrationOptions options;
  options.max_iterations = 1;
  const RegistrationResult found = register_clouds(cloud, cloud, options);
  Point3 centre = Point3::Zero();
  for (const CloudPoint& point : cloud) centre += at(point) / static_cast<double>(cloud.size());
  Matrix6 expected = Matrix6::Zero();
  std::size_t pairs = 0;
  for (const CloudPoint& point : cloud) {
    const std::optional<Point3> normal = brute_normal(cloud, at(point), options.neighbours);
    if (!normal) continue;  // near an edge
    ++pairs;
    Tangent3 row;
    for (Eigen::Index i = 0; i < 6; ++i) {
      constexpr double kStep = 1e-6;
      Tangent3 step = Tangent3::Zero();
      step[i] = kStep;
      const Pose3 T = exp_se3(step);
      row[i] = normal->dot(T * Point3(at(point) - centre) + centre - at(point)) / kStep;
    }
    expected += row * row.transpose();
  }
  EXPECT_EQ(found.pairs, pairs);
  EXPECT_LT((found.information - expected).norm(), 1e-4 * expected.norm());
}

}  // namespace
}  // namespace gdtslam
