// What happened when, against a robot whose crank and wheels turn by known formulas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/linkage/linkage_cycle.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "scanning_room.hpp"
#include "viewer/scene/scan/scanning_track.hpp"

namespace gdtslam {
namespace {

using namespace test;
using ::testing::HasSubstr;

std::string error_of(const Cloud& cloud, const Trajectory& trajectory, double from_s, double to_s) {
  try {
    const ScanningTrack track(cloud, trajectory, from_s, to_s);
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

TEST(ScanningTrack, crank_is_the_one_that_turned) {
  for (const char* preset : {"paper-a", "paper-b", "paper-c"}) {
    ScanningRoom room;
    room.model = calib::sweep_model_of_preset(preset);
    for (const int direction : {1, -1}) {
      room.model.encoder.direction = direction;
      const Cloud cloud = room.cloud();
      const ScanningTrack track(cloud, room.trajectory(), 0.0, room.length_s);
      const calib::LinkageCycle cycle(room.model);
      for (int i = 0; i < 300; ++i) {
        const double stamp_s = 0.1 + 7.7 * i / 300.0;
        const double truth_rad = room.crank_rad(stamp_s);
        const double rate = *calib::elevation_rate(room.model, truth_rad);
        const double found_rad =
            cycle.crank_of(track.elevation_rad(stamp_s), track.is_rising(stamp_s), room.model.encoder.direction);
        // Next to a dead point the elevation says little of the crank.
        const double tolerance_rad = std::fabs(rate) < 0.05 ? 0.12 : 0.004;
        EXPECT_NEAR(wrap_angle(found_rad - truth_rad), 0.0, tolerance_rad)
            << preset << ", direction " << direction << ", after " << stamp_s << " s";
      }
    }
  }
}

TEST(ScanningTrack, counts_what_was_measured) {
  const ScanningRoom room;
  Cloud cloud = room.cloud();
  std::reverse(cloud.begin(), cloud.end());  // no order is asked for
  const ScanningTrack track(cloud, room.trajectory(), 2.0, 5.0);
  for (const double stamp_s : {1.0, 2.0, 2.0001, 3.3, 4.9999, 5.0, 9.0}) {
    const auto truth = std::count_if(cloud.begin(), cloud.end(), [&](const CloudPoint& point) {
      return point.stamp_s >= 2.0 && point.stamp_s <= std::min(stamp_s, 5.0);
    });
    EXPECT_EQ(track.count_until(stamp_s), static_cast<std::size_t>(truth)) << stamp_s;
  }
  EXPECT_TRUE(track.measured_between(3.0, 3.0).empty());
  for (const CloudPoint& point : track.measured_between(3.0, 3.3)) {
    EXPECT_GT(point.stamp_s, 3.0);
    EXPECT_LE(point.stamp_s, 3.3);
  }
}

TEST(ScanningTrack, last_scan_is_whole) {
  const ScanningRoom room;
  const ScanningTrack track(room.cloud(), room.trajectory(), 0.0, room.length_s);
  EXPECT_TRUE(track.last_scan(0.002).empty());
  // Scan 40 fires from 1.0 s to 1.0125 s.
  const auto scan = track.last_scan(1.005);
  ASSERT_EQ(scan.size(), static_cast<std::size_t>(room.beams));
  EXPECT_EQ(scan.front().scan, 39U);
  EXPECT_EQ(track.last_scan(1.02).front().scan, 40U);
  EXPECT_EQ(track.last_scan(1.02).size(), static_cast<std::size_t>(room.beams));
  EXPECT_EQ(track.last_scan(1e9).front().scan, 319U);
}

TEST(ScanningTrack, finds_where_the_sensor_sits) {
  for (const double forward_m : {0.0, 0.17, -0.08}) {
    ScanningRoom room;
    room.sensor_forward_m = forward_m;
    const ScanningTrack track(room.cloud(), room.trajectory(), 0.0, room.length_s);
    EXPECT_NEAR(track.sensor_forward_m(room.model.mount), forward_m, 1e-4);
  }
}

TEST(ScanningTrack, poses_lie_between_those_of_the_log) {
  const ScanningRoom room;
  const ScanningTrack track(room.cloud(), room.trajectory(), 0.0, room.length_s);
  for (const double stamp_s : {0.0, 0.4, 3.75, 8.0}) {
    const Pose2 truth = room.T_map_base(stamp_s);
    const Pose2 pose = track.T_map_base(stamp_s);
    EXPECT_NEAR(pose.x_m, truth.x_m, 1e-9);
    EXPECT_NEAR(pose.y_m, truth.y_m, 1e-9);
    EXPECT_NEAR(pose.theta_rad, truth.theta_rad, 1e-9);
  }
  EXPECT_NEAR(track.T_map_base_smooth(4.0).x_m, room.T_map_base(4.0).x_m, 1e-9);
  EXPECT_NEAR(track.usual_range_m(), 2.2, 0.6);
}

TEST(ScanningTrack, says_what_is_missing) {
  const ScanningRoom room;
  const Cloud cloud = room.cloud();
  EXPECT_THAT(error_of(cloud, room.trajectory(), 3.0, 3.0), HasSubstr("has no length"));
  EXPECT_THAT(error_of(cloud, room.trajectory(), 20.0, 30.0), HasSubstr("times go from 0.000 to 7.9"));
  EXPECT_THAT(error_of({}, room.trajectory(), 0.0, 1.0), HasSubstr("no points"));
  EXPECT_THAT(error_of(cloud, {}, 0.0, 1.0), HasSubstr("trajectory is empty"));
}

}  // namespace
}  // namespace gdtslam
