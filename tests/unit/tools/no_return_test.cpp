// Constants that stand for "nothing seen", among ranges of walls made by hand and of a drive through a room.
#include "engine/runs/streams/no_return.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "drive_log.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {
namespace {

using test::DriveLog;
using testing::HasSubstr;

const ScanConfig kScan;

/// 180 beams of a laser at `x_m` on its way along a wall; rows of beams in front see nothing.
LaserScan scan_at(double x_m, float nothing_m, double limit_m, Random& random) {
  LaserScan scan;
  scan.max_range_m = limit_m;
  for (int beam = 0; beam < 180; ++beam) {
    const double wall_m = 1.0 + 0.02 * beam + 0.4 * std::sin(x_m + 0.1 * beam) + 0.01 * random.normal();
    scan.ranges_m.push_back(beam >= 60 && beam < 90 ? nothing_m : static_cast<float>(wall_m));
  }
  return scan;
}

NoReturns found_in(const std::function<LaserScan(int)>& scan_of) {
  NoReturnFinder finder;
  for (int k = 0; k < 100; ++k) finder.add(scan_of(k), 0);
  return finder.finish();
}

TEST(NoReturn, IsTakenBelowTheStatedLimitAndWithoutOne) {
  for (const double limit_m : {8.0, 0.0, 30.0}) {
    Random random(1);
    const NoReturns found = found_in([&](int k) { return scan_at(0.2 * k, 7.99F, limit_m, random); });
    const auto taken = found.taken(kScan);
    ASSERT_TRUE(taken) << limit_m;
    EXPECT_EQ(taken->range_m, 7.99);
    EXPECT_EQ(taken->beams, 3000U);
    EXPECT_FALSE(found.ambiguous(kScan));
    const LogFinding finding = no_return_finding(*taken, found.beams);
    EXPECT_EQ(finding.options, "--set log.max_range=7.99m");
    EXPECT_THAT(finding.evidence, HasSubstr("16.7 %"));
  }
}

// The end of a corridor, measured in whole centimetres by a laser that stands.
TEST(NoReturn, AWallThatAStandingLaserSeesIsAmbiguous) {
  Random random(3);
  const NoReturns found = found_in([&](int) { return scan_at(0.0, 20.0F, 0.0, random); });
  EXPECT_FALSE(found.taken(kScan));
  ASSERT_TRUE(found.ambiguous(kScan));
  EXPECT_EQ(no_return_option(*found.ambiguous(kScan)), "--set log.max_range=20m");
}

TEST(NoReturn, LonelyBeamsAndFartherWallsAreAmbiguous) {
  Random random(4);
  const auto lonely = [&](int k) {
    LaserScan scan = scan_at(0.2 * k, 5.0F, 0.0, random);
    for (std::size_t beam = 60; beam < 90; ++beam) scan.ranges_m[beam] = beam % 2 == 0 ? 7.99F : 2.0F;
    return scan;
  };
  EXPECT_FALSE(found_in(lonely).taken(kScan));
  EXPECT_TRUE(found_in(lonely).ambiguous(kScan));
  const auto with_farther = [&](int k) {
    LaserScan scan = scan_at(0.2 * k, 7.99F, 0.0, random);
    scan.ranges_m[0] = static_cast<float>(random.uniform(8.2, 9.0));
    return scan;
  };
  EXPECT_FALSE(found_in(with_farther).taken(kScan));
  EXPECT_TRUE(found_in(with_farther).ambiguous(kScan));
}

// log.max_range would replace the limit of the second laser, whose own 5 m would be walls then.
TEST(NoReturn, AnotherLaserWithALowerLimitKeepsIt) {
  Random random(5);
  NoReturnFinder finder;
  for (int k = 0; k < 100; ++k) {
    finder.add(scan_at(0.2 * k, 7.99F, 8.0, random), 0);
    finder.add(scan_at(0.2 * k, 5.0F, 5.0, random), 1);
  }
  EXPECT_FALSE(finder.finish().taken(kScan));
  EXPECT_TRUE(finder.finish().ambiguous(kScan));
}

/// Nothing beyond 2.5 m is seen, and 2.49 m is given for it.
std::string short_sighted_log(const DriveLog& log) {
  return log.write([](LaserScan& scan) {
    scan.max_range_m = 2.5;
    for (float& range_m : scan.ranges_m) range_m = range_m < 2.5F ? range_m : 2.49F;
  });
}

TEST(NoReturn, OfFilesTheValueBecomesTheLimitUnlessOneIsStated) {
  const DriveLog log;
  const std::string path = short_sighted_log(log);
  const auto go_on = [] { return false; };
  Settings settings;
  EXPECT_EQ(take_no_return({path}, {}, false, settings, go_on).size(), 1U);
  EXPECT_EQ(settings.log.max_range_m, 2.49);
  settings.log.max_range_m = 3.0;
  EXPECT_TRUE(take_no_return({path}, {}, false, settings, go_on).empty());
  EXPECT_EQ(settings.log.max_range_m, 3.0);
  settings.log.max_range_m = 0.0;
  EXPECT_TRUE(take_no_return({"-"}, {}, false, settings, go_on).empty());
}

TEST(NoReturn, TheMapIsThatOfALogWhichSaysSo) {
  const DriveLog log;
  const test::MappedLog found = log.map(short_sighted_log(log));
  ASSERT_EQ(found.findings.size(), 1U);
  EXPECT_TRUE(found.findings[0].is_mended);
  const test::MappedLog stated = log.map(log.write([](LaserScan& scan) {
    scan.max_range_m = 2.49;
    for (float& range_m : scan.ranges_m) range_m = range_m < 2.5F ? range_m : 2.5F;
  }));
  EXPECT_TRUE(stated.findings.empty());
  EXPECT_EQ(found.trajectory_sha256, stated.trajectory_sha256);
}

}  // namespace
}  // namespace gdtslam
