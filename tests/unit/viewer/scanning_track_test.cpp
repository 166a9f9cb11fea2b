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

}  // namespace
}  // namespace gdtslam
