// The plane fit against a singular value decomposition, and its standard deviations against repeated measurements.
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <numeric>

#include "engine/core/to_position.hpp"
#include "gdtslam/cloud/plane.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

std::vector<std::uint32_t> all_of(const Cloud& cloud) {
  std::vector<std::uint32_t> points(cloud.size());
  std::iota(points.begin(), points.end(), 0U);
  return points;
}

CloudPoint point_at(const Point3& p) {
  return {.x_m = static_cast<float>(p.x()), .y_m = static_cast<float>(p.y()), .z_m = static_cast<float>(p.z())};
}

/// A rectangle a x b about a centre, spanned by two directions, with noise along its normal.
Cloud rectangle(const Point3& centre, const Eigen::Matrix3d& axes, double a_m, double b_m, std::size_t count,
                double sigma_m, Random& random) {
  Cloud cloud;
  for (std::size_t k = 0; k < count; ++k) {
    const Point3 local(random.uniform(-a_m / 2, a_m / 2), random.uniform(-b_m / 2, b_m / 2), random.normal(0, sigma_m));
    cloud.push_back(point_at(centre + axes * local));
  }
  return cloud;
}

Eigen::Matrix3d random_axes(Random& random) {
  const Eigen::Quaterniond turn(random.normal(), random.normal(), random.normal(), random.normal());
  return turn.normalized().toRotationMatrix();
}

TEST(FitPlane, AgreesWithTheSmallestSingularVector) {
  Random random(1);
  for (int k = 0; k < 50; ++k) {
    const Point3 centre(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-3, 3));
    const Cloud cloud = rectangle(centre, random_axes(random), 3.0, 1.0, 5 + random.below(500), 0.01, random);
    const PlanePatch patch = fit_plane(cloud, all_of(cloud));
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(cloud.size()), 3);
    for (std::size_t i = 0; i < cloud.size(); ++i) rows.row(static_cast<Eigen::Index>(i)) = to_position(cloud[i]);
    const Eigen::RowVector3d mean = rows.colwise().mean();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows.rowwise() - mean, Eigen::ComputeThinV);
    EXPECT_NEAR(std::fabs(svd.matrixV().col(2).dot(patch.plane.normal)), 1.0, 1e-12);
    EXPECT_NEAR(patch.plane.normal.norm(), 1.0, 1e-14);
    EXPECT_NEAR((patch.centre - mean.transpose()).norm(), 0.0, 1e-12);
    EXPECT_NEAR(patch.plane.distance_m(mean.transpose()), 0.0, 1e-12);
    EXPECT_NEAR(patch.rms_m, svd.singularValues()[2] / std::sqrt(static_cast<double>(cloud.size())), 1e-10);
    EXPECT_EQ(patch.points, all_of(cloud));
  }
}

TEST(FitPlane, KnownPlaneWithoutNoise) {
  const Cloud cloud{{.x_m = 0, .y_m = 0, .z_m = 1}, {.x_m = 1, .y_m = 0, .z_m = 0}, {.x_m = 0, .y_m = 1, .z_m = 0}};
  const PlanePatch patch = fit_plane(cloud, all_of(cloud));
  EXPECT_NEAR(std::fabs(patch.plane.offset_m), 1.0 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(std::fabs(patch.plane.normal.sum()), std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(patch.rms_m, 0.0, 1e-8);
}

TEST(FitPlane, TheMiddleOfNowhereCostsNoAccuracy) {
  Random random(2);
  Eigen::Matrix3d axes = random_axes(random);
  const Cloud cloud = rectangle(Point3(5000, -8000, 100), axes, 4.0, 4.0, 2000, 0.0, random);
  const PlanePatch patch = fit_plane(cloud, all_of(cloud));
  EXPECT_NEAR(std::fabs(patch.plane.normal.dot(axes.col(2))), 1.0, 1e-6);  // floats there are 0.5 mm apart
  EXPECT_LT(patch.rms_m, 5e-4);
}

TEST(FitPlane, LinesAndTooFewPointsAreErrors) {
  Cloud line;
  for (int k = 0; k < 100; ++k) {
    const float s = static_cast<float>(k) * 0.037F;
    line.push_back({.x_m = 100.0F + s, .y_m = 3.0F * s - 7.0F, .z_m = 0.3F * s});
  }
  EXPECT_THROW(fit_plane(line, all_of(line)), InputError);
  EXPECT_THROW(fit_plane(line, std::vector<std::uint32_t>{1, 2}), InputError);
  EXPECT_THROW(fit_plane(line, std::vector<std::uint32_t>{1, 1, 1}), InputError);
  line.push_back({.x_m = 101.0F, .y_m = 0.0F, .z_m = 1.0F});
  EXPECT_NO_THROW(fit_plane(line, all_of(line)));
}

// 2000 repeated measurements of one rectangle: the scatter of the estimates is what one fit says of itself.
TEST(FitPlane, StandardDeviationsAreThoseOfRepeatedMeasurements) {
  constexpr int kRuns = 2000;
  constexpr double kSigma_m = 0.01;
  Random random(7);
  const Point3 centre(3.0, -2.0, 1.0);
  const Eigen::Matrix3d axes = random_axes(random);
  for (const std::size_t count : {30U, 300U}) {
    double offset2 = 0.0;
    double tilt2 = 0.0;
    double said_offset = 0.0;
    double said_tilt = 0.0;
    for (int run = 0; run < kRuns; ++run) {
      const Cloud cloud = rectangle(centre, axes, 3.0, 0.8, count, kSigma_m, random);
      const PlanePatch patch = fit_plane(cloud, all_of(cloud));
      const double error_m = (patch.centre - centre).dot(axes.col(2));
      // The worse direction turns about the long side: the normal moves along the short one.
      const double tilt_rad = patch.plane.normal.dot(axes.col(1)) / patch.plane.normal.dot(axes.col(2));
      offset2 += error_m * error_m;
      tilt2 += tilt_rad * tilt_rad;
      said_offset += patch.sigma_centre_m;
      said_tilt += patch.sigma_normal_rad;
    }
    EXPECT_NEAR(said_offset / kRuns / std::sqrt(offset2 / kRuns), 1.0, 0.15) << count;
    EXPECT_NEAR(said_tilt / kRuns / std::sqrt(tilt2 / kRuns), 1.0, 0.15) << count;
  }
}

// Of a wall that lies far aside of the foot of its perpendicular, whose offset its direction tells more than its
// points.
TEST(FitPlane, TheOffsetScattersAsItSays) {
  constexpr int kRuns = 1000;
  Random random(11);
  const Eigen::Matrix3d axes = random_axes(random);
  const Point3 centre = axes * Point3(9.0, 2.0, 4.0);
  double off2 = 0.0;
  double said = 0.0;
  double said_at_centre = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    const Cloud cloud = rectangle(centre, axes, 2.0, 1.0, 200, 0.01, random);
    const PlanePatch patch = fit_plane(cloud, all_of(cloud));
    const double error_m = std::fabs(patch.plane.offset_m) - 4.0;
    off2 += error_m * error_m;
    said += patch.sigma_offset_m;
    said_at_centre += patch.sigma_centre_m;
  }
  EXPECT_NEAR(said / kRuns / std::sqrt(off2 / kRuns), 1.0, 0.1);
  EXPECT_GT(said, 10.0 * said_at_centre);
}

}  // namespace
}  // namespace gdtslam
