// Bounds of linkages and of scans that wait for odometry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "engine/runs/linkage/linkage_file.hpp"
#include "engine/runs/streams/odometry_delay.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

ScanRecord scan_at_x(double stamp_s, double x_m) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  record.T_odom_base = Pose2{x_m, 0.0, 0.0};
  return record;
}

TEST(OdometryShiftRules, NoMoreThanSoManyWait) {
  OdometryShift shift(1.0e6);
  for (int k = 0; k < 511; ++k) shift.take(scan_at_x(0.001 * k, k));
  EXPECT_FALSE(shift.next(false));
  shift.take(scan_at_x(0.511, 511.0));
  const auto first = shift.next(false);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->T_odom_base->x_m, 511.0) << "the last that is known";
  EXPECT_FALSE(shift.next(false));
}

TEST(LinkageRules, WhatIsSupposedHasToBeStatedWhereTheCrankCannotTurn) {
  const auto refusal = [](const std::string& lines) -> std::string {
    try {
      static_cast<void>(read_linkage_text("gdtslam_linkage: 1\n" + lines, "l.yaml"));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string bars = "bars: {crank: 6 cm, coupler: 8.5 cm, rocker: 8.8 cm, ground: 12 cm}\n";
  EXPECT_THAT(refusal(bars + "elevation: {offset: 10 deg}\n"), HasSubstr("or give encoder.zero too"));
  EXPECT_THAT(refusal(bars + "encoder: {zero: 1 deg}\n"), HasSubstr("or give elevation.offset too"));
  EXPECT_THAT(refusal(bars + "encoder: {direction: -1}\nelevation: {offset: 10 deg}\n"),
              HasSubstr("or give encoder.zero too"));
  EXPECT_EQ(refusal("preset: paper-b\nencoder: {ticks_per_turn: 1e15}\n").find("whole number"), std::string::npos);
  EXPECT_THAT(refusal("preset: paper-b\nencoder: {ticks_per_turn: 1.1e15}\n"), HasSubstr("not a whole number"));
  EXPECT_THAT(refusal("preset: paper-b\nencoder: {ticks_per_turn: -1.1e15}\n"), HasSubstr("not a whole number"));
  EXPECT_THAT(refusal("preset: paper-b\nelevation: {sign: 0}\n"), HasSubstr("must be 1 or -1"));
  EXPECT_EQ(refusal("preset: paper-b\nuncertainty: {crank: 0 mm}\n"), "accepted") << "exactly known";
}

TEST(LinkageRules, ASidecarHasTheLogsNameWithoutItsEndings) {
  for (const char* log : {"a/drive", "a/drive.log", "a/drive.clf.gz", "a/drive.log.bz2", "a/drive.csv.zst",
                          "a/drive.jsonl.xz", "a/drive.mcap", "a/drive.bag", "a/drive.db3", "a/drive/"}) {
    EXPECT_EQ(sidecar_path(log, ".linkage.yaml"), "a/drive.linkage.yaml") << log;
  }
  EXPECT_EQ(sidecar_path("a/drive.txt", ".x"), "a/drive.txt.x");
  EXPECT_EQ(linkage_sidecar("-"), "");
}

}  // namespace
}  // namespace gdtslam
