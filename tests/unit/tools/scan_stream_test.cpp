#include "engine/runs/streams/scan_stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

ScanRecord bare_scan(double stamp_s) {
  ScanRecord record;
  record.scan.stamp_s = stamp_s;
  return record;
}

TEST(OdometryInterpolator, ScansBeforeAnyOdometryPassWithout) {
  OdometryInterpolator interpolator;
  interpolator.take(bare_scan(1.0));
  const auto scan = interpolator.next(false);
  ASSERT_TRUE(scan);
  EXPECT_FALSE(scan->T_odom_base);
}

TEST(OdometryInterpolator, HalfWayInTimeIsHalfWayAlongTheArc) {
  // A quarter of a circle of radius 1 to the left: half of it ends at (sin 45, 1 - cos 45), heading 45 degrees.
  OdometryInterpolator interpolator;
  interpolator.take(Odometry{10.0, {}});
  interpolator.take(bare_scan(11.0));
  EXPECT_FALSE(interpolator.next(false));  // it waits for the record after it
  interpolator.take(Odometry{12.0, {1.0, 1.0, kPi / 2}});
  const auto scan = interpolator.next(false);
  ASSERT_TRUE(scan && scan->T_odom_base);
  EXPECT_NEAR(scan->T_odom_base->x_m, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(scan->T_odom_base->y_m, 1.0 - std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(scan->T_odom_base->theta_rad, kPi / 4, 1e-12);
}

TEST(OdometryInterpolator, StampsOutsideOfTheRecordsAreClamped) {
  OdometryInterpolator interpolator;
  interpolator.take(Odometry{10.0, {1.0, 0.0, 0.0}});
  interpolator.take(bare_scan(9.0));
  interpolator.take(bare_scan(13.0));
  interpolator.take(Odometry{12.0, {2.0, 0.0, 0.0}});
  EXPECT_EQ(interpolator.next(false)->T_odom_base->x_m, 1.0);
  EXPECT_NEAR(interpolator.next(false)->T_odom_base->x_m, 2.0, 1e-12);
  interpolator.take(bare_scan(12.5));
  interpolator.take(Odometry{11.0, {3.0, 0.0, 0.0}});  // the clock went backward
  EXPECT_EQ(interpolator.next(false)->T_odom_base->x_m, 2.0);
}

TEST(OdometryInterpolator, TheEndAndALongSilenceTakeTheLastPose) {
  OdometryInterpolator interpolator;
  interpolator.take(Odometry{10.0, {1.0, 0.0, 0.0}});
  for (std::size_t k = 0; k <= OdometryInterpolator::kMostHeld; ++k)
    interpolator.take(bare_scan(11.0 + static_cast<double>(k)));
  for (std::size_t k = 0; k <= OdometryInterpolator::kMostHeld; ++k) {
    const auto scan = interpolator.next(false);
    ASSERT_TRUE(scan) << k;
    EXPECT_EQ(scan->scan.stamp_s, 11.0 + static_cast<double>(k));
    EXPECT_EQ(scan->T_odom_base->x_m, 1.0);
  }
  interpolator.take(bare_scan(500.0));
  EXPECT_FALSE(interpolator.next(false));
  EXPECT_EQ(interpolator.next(true)->T_odom_base->x_m, 1.0);
  EXPECT_FALSE(interpolator.next(true));
}

TEST(OdometryInterpolator, OwnOdometryCountsAndOrderIsKept) {
  OdometryInterpolator interpolator;
  interpolator.take(Odometry{10.0, {1.0, 0.0, 0.0}});
  interpolator.take(bare_scan(10.5));
  ScanRecord own = bare_scan(10.6);
  own.T_odom_base = Pose2{7.0, 0.0, 0.0};
  interpolator.take(own);
  EXPECT_EQ(interpolator.next(false)->scan.stamp_s, 10.5);
  EXPECT_EQ(interpolator.next(false)->T_odom_base->x_m, 7.0);
}

class ScanStreamTest : public testing::Test {
 public:
  ScanStreamTest() {
    std::string name = (std::filesystem::temp_directory_path() / "gdtslam-stream-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~ScanStreamTest() override { std::filesystem::remove_all(folder_); }

 protected:
  // A log of scans at these x of the odometry, one a second.
  std::string log(const std::string& name, const std::vector<double>& xs_m) {
    std::string path = folder_ / name;
    std::ofstream file(path);
    int second = 0;
    for (const double x_m : xs_m) {
      file << "FLASER 3 1.0 2.0 3.0 " << x_m << " 0 0 " << x_m << " 0 0 " << second << " host " << second << "\n";
      ++second;
    }
    return path;
  }

  static std::vector<double> xs_of(ScanStream& stream) {
    std::vector<double> xs_m;
    while (const auto scan = stream.next()) xs_m.push_back(scan->T_odom_base->x_m);
    return xs_m;
  }

  std::filesystem::path folder_;
};

TEST_F(ScanStreamTest, LaterLogsContinueWhereTheOneBeforeEnded) {
  ScanStream stream({log("a", {1.0, 2.0}), log("b", {50.0, 51.5}), log("c", {0.0, -1.0})}, {}, {});
  EXPECT_EQ(xs_of(stream), (std::vector<double>{1.0, 2.0, 2.0, 3.5, 3.5, 2.5}));
  EXPECT_EQ(stream.progress(), 1.0);
  EXPECT_TRUE(stream.warnings().empty());
}

TEST_F(ScanStreamTest, SkipAndFirstCountOverAllLogs) {
  const std::vector<std::string> logs{log("a", {1.0, 2.0}), log("b", {2.0, 3.0, 4.0})};
  ScanStream some(logs, {}, {.skip = 1, .count = 3});
  EXPECT_EQ(xs_of(some), (std::vector<double>{2.0, 2.0, 3.0}));
  ScanStream none(logs, {}, {.skip = 100});
  EXPECT_TRUE(xs_of(none).empty());
  ScanStream zero(logs, {}, {.count = 0});
  EXPECT_TRUE(xs_of(zero).empty());
}

TEST_F(ScanStreamTest, WarningsOfAllLogsAreAddedUp) {
  std::ofstream(folder_ / "a") << "FLASER 1 1.0 0 0 0 0 0 0 1 h 1\nFLASER 1 1.0 0 0 0 0 0 0 1 h 1\n";
  std::ofstream(folder_ / "b") << "FLASER 1 1.0 0 0 0 0 0 0 5 h 5\nFLASER 1 1.0 0 0 0 0 0 0 5 h 5\n";
  ScanStream stream({folder_ / "a", folder_ / "b"}, {}, {});
  EXPECT_EQ(xs_of(stream).size(), 4u);
  const auto warnings = stream.warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].kind, "repeated stamp");
  EXPECT_EQ(warnings[0].count, 2u);
}

TEST_F(ScanStreamTest, ALogThatCannotBeOpenedIsAnErrorWhenItsTurnComes) {
  ScanStream stream({log("a", {1.0}), (folder_ / "nowhere").string()}, {}, {});
  EXPECT_TRUE(stream.next());
  EXPECT_THROW(stream.next(), FileError);
}

}  // namespace
}  // namespace gdtslam
