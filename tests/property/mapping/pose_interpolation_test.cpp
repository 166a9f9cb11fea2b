// Laws of the poses between two fixes.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "engine/mapping/nodding/pose_path.hpp"
#include "property/core/generators.hpp"

namespace gdtslam {
namespace {

using test::near_pose;

/// Motions that turn by clearly less than half a turn, whose log is not ambiguous.
Pose2 draw_motion() { return {*test::real(5.0), *test::real(5.0), *test::real(2.5)}; }
Pose2 draw_pose() { return {*test::real(1000.0), *test::real(1000.0), *test::angle()}; }

PoseInterpolation draw_way() {
  return *rc::gen::element(PoseInterpolation::kLinear, PoseInterpolation::kGeodesic, PoseInterpolation::kOdometry);
}

struct Stretch {
  PoseFix from;
  PoseFix to;
};

Stretch draw_stretch() {
  const Pose2 start = draw_pose();
  const Pose2 odom_start = draw_pose();
  return {{1.0, start, odom_start}, {2.0, start * draw_motion(), odom_start * draw_motion()}};
}

RC_GTEST_PROP(PoseInterpolationLaws, BeginsAndEndsAtTheFixes, ()) {
  const Stretch s = draw_stretch();
  const PoseInterpolation way = draw_way();
  RC_ASSERT(near_pose(s.from.T_map_base, interpolate(way, s.from, s.to, 0.0, s.from.T_odom_base), 1e-9, 1e-9));
  RC_ASSERT(near_pose(s.to.T_map_base, interpolate(way, s.from, s.to, 1.0, s.to.T_odom_base), 1e-9, 1e-9));
}

RC_GTEST_PROP(PoseInterpolationLaws, TurnedMapsTurnThePoses, ()) {
  const Stretch s = draw_stretch();
  const PoseInterpolation way = draw_way();
  const Pose2 T_new_map = draw_pose();
  const Pose2 T_odom_base = s.from.T_odom_base * draw_motion();
  const double share = 0.5 + *test::real(0.5);
  const PoseFix from{1.0, T_new_map * s.from.T_map_base, s.from.T_odom_base};
  const PoseFix to{2.0, T_new_map * s.to.T_map_base, s.to.T_odom_base};
  RC_ASSERT(near_pose(T_new_map * interpolate(way, s.from, s.to, share, T_odom_base),
                      interpolate(way, from, to, share, T_odom_base), 1e-8, 1e-8));
}

RC_GTEST_PROP(PoseInterpolationLaws, GeodesicIsTheSameBackwards, ()) {
  const Stretch s = draw_stretch();
  const double share = 0.5 + *test::real(0.5);
  RC_ASSERT(near_pose(interpolate(PoseInterpolation::kGeodesic, s.from, s.to, share, {}),
                      interpolate(PoseInterpolation::kGeodesic, s.to, s.from, 1.0 - share, {}), 1e-8, 1e-8));
}

RC_GTEST_PROP(PoseInterpolationLaws, OdometryThatAgreesIsFollowed, ()) {
  const Stretch s = draw_stretch();
  const Pose2 T_map_odom = s.from.T_map_base * inverse(s.from.T_odom_base);
  PoseFix to = s.to;
  to.T_map_base = T_map_odom * to.T_odom_base;
  const Pose2 T_odom_base = s.from.T_odom_base * draw_motion();
  const double share = 0.5 + *test::real(0.5);
  RC_ASSERT(near_pose(T_map_odom * T_odom_base,
                      interpolate(PoseInterpolation::kOdometry, s.from, to, share, T_odom_base), 1e-8, 1e-8));
}

}  // namespace
}  // namespace gdtslam
