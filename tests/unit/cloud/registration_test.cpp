// register_clouds: motions that are known, scenes that do not hold all of a motion.
#include "engine/cloud/registration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/cloud_scenes.hpp"

namespace gdtslam {
namespace {

using test::moved;
using test::Rectangle;
using test::strew;

// A furnished room, each time with other points on the same surfaces.
Cloud room_cloud(std::uint64_t seed, double noise_m) {
  Random random(seed);
  Cloud cloud;
  for (const Rectangle& side : test::room({5.0, 4.0, 2.5})) strew(cloud, side, 2'500, noise_m, random);
  for (const Rectangle& side : test::box_sides({1.5, 1.2, 0.0}, 0.4, {1.2, 0.8, 0.9}))
    strew(cloud, side, 800, noise_m, random);
  return cloud;
}

double shift_of(const Pose3& T) { return T.translation_m.norm(); }
double turn_of(const Pose3& T) { return log_so3(T.rotation).norm(); }

TEST(RegisterClouds, RecoversAKnownMotion) {
  const Cloud target = room_cloud(1, 0.01);
  Random random(2);
  for (int k = 0; k < 5; ++k) {
    Tangent3 motion;
    for (Eigen::Index i = 0; i < 3; ++i) motion[i] = random.uniform(-0.06, 0.06);
    for (Eigen::Index i = 3; i < 6; ++i) motion[i] = random.uniform(-0.02, 0.02);
    const Pose3 T_source_target = exp_se3(motion);
    const Cloud source = moved(room_cloud(10 + static_cast<std::uint64_t>(k), 0.01), T_source_target);
    const RegistrationResult found = register_clouds(source, target, {});
    EXPECT_TRUE(found.converged);
    const Pose3 left_over = found.T_target_source * T_source_target;
    // Noise of 1 cm on 4000 points against normals from a dozen points each: a few millimetres at most.
    EXPECT_LT(shift_of(left_over), 0.004);
    EXPECT_LT(turn_of(left_over), 0.002);
    EXPECT_LT(found.rms_m, found.rms_before_m);
    EXPECT_NEAR(found.rms_m, 0.01 * std::sqrt(2.0), 0.006);  // both clouds have noise; far pairs are left out
    EXPECT_GT(found.weakest_share, 0.01);
  }
}

TEST(RegisterClouds, EqualCloudsNeedNextToNoMotion) {
  const Cloud cloud = room_cloud(3, 0.01);
  const RegistrationResult found = register_clouds(cloud, cloud, {});
  EXPECT_TRUE(found.converged);
  EXPECT_LT(shift_of(found.T_target_source), 0.001);  // noisy points lie off the planes through their neighbours
  EXPECT_LT(turn_of(found.T_target_source), 0.0005);
  EXPECT_LT(found.rms_m, 0.01);  // the noise
}

TEST(RegisterClouds, SweepsOfOneRoomThatAreNotMovedAgree) {
  const RegistrationResult found = register_clouds(room_cloud(4, 0.01), room_cloud(5, 0.01), {});
  EXPECT_TRUE(found.converged);
  EXPECT_LT(shift_of(found.T_target_source), 0.003);
  EXPECT_LT(turn_of(found.T_target_source), 0.0015);
}

TEST(RegisterClouds, OneWallHoldsNoMotionAlongItself) {
  Random random(6);
  const Rectangle wall{{0.0, 0.0, 0.0}, {4.0, 0.0, 0.0}, {0.0, 0.0, 2.5}};
  Cloud source;
  Cloud target;
  strew(source, wall, 4'000, 0.005, random);
  strew(target, wall, 4'000, 0.005, random);
  EXPECT_LT(register_clouds(source, target, {}).weakest_share, 3e-3);
  // A corridor: two walls, floor and ceiling hold all but the way along it.
  for (const Rectangle& side :
       {Rectangle{{0, 2, 0}, {4, 0, 0}, {0, 0, 2.5}}, Rectangle{{0, 0, 0}, {4, 0, 0}, {0, 2, 0}},
        Rectangle{{0, 0, 2.5}, {4, 0, 0}, {0, 2, 0}}}) {
    strew(source, side, 4'000, 0.005, random);
    strew(target, side, 4'000, 0.005, random);
  }
  EXPECT_LT(register_clouds(source, target, {}).weakest_share, 1e-2);
  const Rectangle end{{4, 0, 0}, {0, 2, 0}, {0, 0, 2.5}};
  strew(source, end, 4'000, 0.005, random);
  strew(target, end, 4'000, 0.005, random);
  EXPECT_GT(register_clouds(source, target, {}).weakest_share, 3e-2);
}

TEST(RegisterClouds, CloudsThatShareNothingDoNotConverge) {
  const Cloud near = room_cloud(7, 0.01);
  const Cloud far = moved(near, exp_se3((Tangent3() << 100.0, 0.0, 0.0, 0.0, 0.0, 0.0).finished()));
  const RegistrationResult found = register_clouds(near, far, {});
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.pairs, 0U);
  EXPECT_EQ(found.T_target_source, Pose3{});
  EXPECT_FALSE(register_clouds({}, near, {}).converged);
  EXPECT_FALSE(register_clouds(near, {}, {}).converged);
}

TEST(RegisterClouds, GivesTheSameBitsAgain) {
  const Cloud source = room_cloud(8, 0.01);
  const Cloud target = room_cloud(9, 0.01);
  const RegistrationResult once = register_clouds(source, target, {});
  const RegistrationResult again = register_clouds(source, target, {});
  EXPECT_EQ(once.T_target_source, again.T_target_source);
  EXPECT_EQ(once.information, again.information);
  EXPECT_EQ(once.rms_m, again.rms_m);
}

}  // namespace
}  // namespace gdtslam
