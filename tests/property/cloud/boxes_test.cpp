// Boxes of any size, place and turn before a standing scanner: what is measured is the truth within what is stated.
#include "gdtslam/cloud/plane.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/cloud_scenes.hpp"

namespace gdtslam {
namespace {

constexpr double kQuarter_rad = 1.5707963267948966;
// What one cloud's seen edges share, and stated uncertainties leave out: the plane of the face, the viewpoint.
constexpr double kShared_m = 6e-4;

struct Drawn {
  Point3 size;  ///< width, depth, height
  Point3 place;
  double yaw_rad = 0.0;
};

// Its front looks at the scanner but for up to 25 deg.
Drawn draw(Random& random) {
  Drawn box;
  box.size = {random.uniform(0.2, 0.9), random.uniform(0.2, 0.5), random.uniform(0.5, 1.1)};
  const double bearing_rad = random.uniform(-0.7, 0.7);
  const double range_m = random.uniform(1.3, 2.2);
  box.place = {range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad), 0.0};
  box.yaw_rad = bearing_rad + kQuarter_rad + random.uniform(-0.43, 0.43);
  return box;
}

TEST(BoxesProperty, TheTruthIsWithinFourSigmaWhateverTheBox) {
  Random random(11);
  for (int k = 0; k < 8; ++k) {
    const Drawn drawn = draw(random);
    std::vector<test::Rectangle> scene = test::room({7.0, 6.0, 2.5});
    for (test::Rectangle& side : scene) side.corner -= Point3(3.0, 3.0, 0.0);
    for (const test::Rectangle& side : test::box_sides(drawn.place, drawn.yaw_rad, drawn.size)) scene.push_back(side);
    const test::StandingScanner scanner;
    BoxSearch search;
    search.viewpoint = scanner.at;
    const std::vector<MeasuredBox> boxes = find_boxes(test::scan(scanner, scene, random), search);
    ASSERT_EQ(boxes.size(), 1U) << "box " << k << ": " << drawn.size.transpose() << " at " << drawn.place.transpose();
    const MeasuredBox& box = boxes[0];
    EXPECT_NEAR(box.width.value_m, drawn.size.x(), 4.0 * box.width.sigma_m + kShared_m) << "box " << k;
    EXPECT_NEAR(box.height.value_m, drawn.size.z(), 4.0 * box.height.sigma_m + kShared_m) << "box " << k;
    EXPECT_LT(box.width.sigma_m, 4e-3);
    EXPECT_TRUE(box.width.is_observed);
    EXPECT_NEAR(std::remainder(box.yaw_rad - drawn.yaw_rad, 2.0 * kQuarter_rad), 0.0, 0.01) << "box " << k;
    if (std::isfinite(box.depth.sigma_m)) {
      EXPECT_NEAR(box.depth.value_m, drawn.size.y(), 4.0 * box.depth.sigma_m + kShared_m) << "box " << k;
    }
  }
}

TEST(PlanesProperty, MovedCloudsHaveMovedPlanes) {
  Random random(12);
  Cloud cloud;
  const test::Rectangle wall{{1.0, 2.0, 0.0}, {2.0, 0.5, 0.0}, {0.0, 0.0, 2.0}};
  test::strew(cloud, wall, 5'000, 0.01, random);
  for (int k = 0; k < 10; ++k) {
    Tangent3 motion;
    for (Eigen::Index i = 0; i < 6; ++i) motion[i] = random.uniform(-2.0, 2.0);
    const Pose3 T = exp_se3(motion);
    const std::vector<PlanePatch> patches = find_planes(test::moved(cloud, T), {});
    ASSERT_EQ(patches.size(), 1U);
    const Point3 normal = T.rotation * wall.normal();
    EXPECT_LT(normal.cross(patches[0].plane.normal).norm(), 3.0 * std::sqrt(2.0) * patches[0].sigma_normal_rad);
    EXPECT_LT(std::fabs(normal.dot(patches[0].centre - T * wall.corner)), 3.0 * patches[0].sigma_centre_m);
  }
}

}  // namespace
}  // namespace gdtslam
