// TUM trajectories and relations.
#include "gdtslam/io/trajectory_file.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::HasSubstr;

std::string trajectory_error(const std::string& text) {
  return told_by<InputError>([&] { read_tum(bytes_of(text), "t.tum"); }, "no error");
}

TEST(Tum, WritesNineDecimalsOfStampAndPose) {
  // sin(30 deg) and cos(30 deg) for a yaw of 60 deg; the half turn has the quaternion (0, 0, 1, 0).
  const Trajectory trajectory = {{976052857.337284, {1.5, -2.25, kPi / 3.0}}, {2.0, {0.0, 0.0, kPi}}};
  EXPECT_EQ(tum_text(trajectory),
            "976052857.337283969 1.500000000 -2.250000000 0.000000000 0.000000000 0.000000000 0.500000000 0.866025404\n"
            "2.000000000 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 1.000000000 0.000000000\n");
}

TEST(Tum, RefusesPosesThatAreNotFinite) {
  EXPECT_THROW(tum_text({{1.0, {std::numeric_limits<double>::quiet_NaN(), 0, 0}}}), Error);
  EXPECT_THROW(tum_text({{std::numeric_limits<double>::infinity(), {0, 0, 0}}}), Error);
}

TEST(Tum, ReadsCommentsBlankLinesAndAnyRotation) {
  const Trajectory trajectory = read_tum(bytes_of("# stamp x y z\n\n"
                                                  "1.5 1 2 3 0 0 0.5 0.8660254037844386\r\n"
                                                  "  2.5\t-1 -2 0 0 0 -0.5 -0.8660254037844386\n"
                                                  "3.5 0 0 0 0 0 -0.7071067811865476 0.7071067811865476"),
                                         "t");
  ASSERT_EQ(trajectory.size(), 3U);
  EXPECT_EQ(trajectory[0].stamp_s, 1.5);
  EXPECT_EQ(trajectory[0].T_map_base.y_m, 2.0);
  EXPECT_NEAR(trajectory[0].T_map_base.theta_rad, kPi / 3.0, 1e-12);
  EXPECT_NEAR(trajectory[1].T_map_base.theta_rad, kPi / 3.0, 1e-12);  // q and -q are one rotation
  EXPECT_NEAR(trajectory[2].T_map_base.theta_rad, -kPi / 2.0, 1e-12);
}

TEST(Tum, ErrorsNameFileLineAndRow) {
  EXPECT_THAT(trajectory_error("1 0 0 0 0 0 0 1\n1 2 3\n"),
              HasSubstr("t.tum:2: the row ends before its numbers; a row is `stamp"));
  EXPECT_THAT(trajectory_error("1 0 0 0 0 0 0 1 9\n"), HasSubstr("t.tum:1: the row has more numbers"));
  EXPECT_THAT(trajectory_error("1 0 0 x 0 0 0 1\n"), HasSubstr("t.tum:1: the row has \"x\""));
  EXPECT_THAT(trajectory_error("1 nan 0 0 0 0 0 1\n"), HasSubstr("not a finite number"));
  EXPECT_THAT(trajectory_error("1 0 0 0 0 0 0 0\n"), HasSubstr("quaternion"));
  EXPECT_THAT(trajectory_error("1 " + std::string(10000, '0') + "\n"), HasSubstr("is too long"));
}

// Squares of what is farther, and their sums, would be no numbers: no error can be told.
TEST(Tum, APlaceThatIsNoneOnEarthIsRefused) {
  EXPECT_THAT(trajectory_error("1 1e9 -1e9 0 0 0 0 1\n2 0 -1.1e9 0 0 0 0 1\n"),
              HasSubstr("t.tum:2: (0, -1.1e+09) is no place"));
  const TemporaryFolder folder;
  put_file(folder / "r", "1 2 1e300 0 0 0 0 0\n");
  EXPECT_THROW(read_relations(folder / "r"), InputError);
}

TEST(Relations, ReadsRows) {
  const TemporaryFolder folder;
  put_file(folder / "r.gz", gzip("10.5 20.5 1 2 0 0 0 3.5\n# comment\n30 40 0 0 0 0 0 -1\n"));
  const std::vector<Relation> relations = read_relations(folder / "r.gz");
  ASSERT_EQ(relations.size(), 2U);
  EXPECT_EQ(relations[0].t1_s, 10.5);
  EXPECT_EQ(relations[0].t2_s, 20.5);
  EXPECT_EQ(relations[0].T_1_2.x_m, 1.0);
  EXPECT_NEAR(relations[0].T_1_2.theta_rad, 3.5 - 2.0 * kPi, 1e-12);
}

TEST(Relations, AYawBeyondAWholeTurnIsAskedForItsUnit) {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& yaw) {
    put_file(folder / "r", "# t1 t2 x y z roll pitch yaw\n1 2 3 4 0 0 0 " + yaw + "\n");
    return told_by<InputError>([&] { read_relations(folder / "r"); }, "");
  };
  for (const char* yaw : {"0", "3.1416", "-3.1416", "6.2832", "-6.2832"}) EXPECT_EQ(error_of(yaw), "") << yaw;
  for (const char* yaw : {"6.3", "-6.3", "90"}) {
    EXPECT_THAT(error_of(yaw), HasSubstr("r:2: the yaw of " + std::string(yaw) + " rad")) << yaw;
    EXPECT_THAT(error_of(yaw), HasSubstr("is it in degrees?")) << yaw;
  }
}

TEST(Relations, ATrajectoryIsToldAsOne) {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& text) {
    put_file(folder / "r", text);
    return told_by<InputError>([&] { read_relations(folder / "r"); }, "");
  };
  EXPECT_THAT(error_of("1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0.6 0.8\n3 2 0 0 0 0 -0.6 0.8\n"), HasSubstr("is a trajectory"));
  put_file(folder / "r", "1 2 0 0 0 0 0 1\n2 3 1 0 0 0 0 1\n");  // two turns of 1 rad
  EXPECT_EQ(read_relations(folder / "r").size(), 2U);
  put_file(folder / "r", "1 2 0 0 0 0 0 1\n2 3 1 0 0 0 0 1\n3 4 1 0 0 0 0 0.5\n");
  EXPECT_EQ(read_relations(folder / "r").size(), 3U);
}

TEST(RelationsRealData, HaveTheirKnownCounts) {
  GDTSLAM_REAL_DATA(intel, "slam2d/intel.relations.gz");
  GDTSLAM_REAL_DATA(fr079, "slam2d/fr079.relations.gz");
  GDTSLAM_REAL_DATA(csail, "slam2d/mit-csail.relations.gz");
  EXPECT_EQ(read_relations(intel).size(), 2984U);
  EXPECT_EQ(read_relations(fr079).size(), 1685U);
  EXPECT_EQ(read_relations(csail).size(), 1172U);
}

}  // namespace
}  // namespace gdtslam
