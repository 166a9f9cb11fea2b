// Every matcher maps a drive through a known room: within a centimetre of the truth, and to the same bits whatever
// threads and instruction set the backend has.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/mapping/match/matchers.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "support/instruction_sets.hpp"
#include "support/mapper_drive.hpp"
#include "support/pose_matchers.hpp"

namespace gdtslam::test {
namespace {

class MatcherDrive : public testing::TestWithParam<MatcherKind> {
 protected:
  // True odometry would hide a matcher that does nothing: this one drifts by 1 cm and 0.3 degrees a scan.
  static std::vector<DriveScan> drifting(std::vector<DriveScan> scans) {
    Pose2 drift;
    const Pose2 first = scans.front().T_odom_base;
    for (DriveScan& scan : scans) {
      scan.T_odom_base = drift * between(first, scan.T_odom_base);
      drift = drift * Pose2{0.007, -0.007, 0.005};
    }
    return scans;
  }
};

TEST_P(MatcherDrive, StaysWithinACentimetreOfTheTruth) {
  const std::vector<DriveScan> truth = room_scans(60, 1);
  const std::vector<DriveScan> scans = drifting(truth);
  MapperConfig config;
  config.match.matcher = GetParam();
  const auto backend = make_cpu_backend({});
  const MappedDrive done = map_drive(scans, config, *backend);
  const Pose2 first = truth.front().T_odom_base;
  double sum_m = 0.0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const Pose2 off = between(between(first, truth[i].T_odom_base), done.poses[i]);
    sum_m += off.translation().norm();
    EXPECT_THAT(done.poses[i], PoseNear(between(first, truth[i].T_odom_base), 0.03, 1.0)) << i;
  }
  EXPECT_LT(sum_m / static_cast<double>(scans.size()), 0.01);
  EXPECT_EQ(done.statistics.matched, scans.size());
  // Odometry alone would be off by more than this.
  EXPECT_GT(between(scans.back().T_odom_base, between(first, truth.back().T_odom_base)).translation().norm(), 0.1);
}

TEST_P(MatcherDrive, CountsItsEvaluations) {
  const auto backend = make_cpu_backend({});
  Mapper mapper(quick_config(GetParam()), *backend);
  std::uint64_t sum = 0;
  for (const DriveScan& scan : room_scans(10, 2)) {
    const MatchResult result = mapper.process(scan.scan, scan.T_odom_base);
    sum += result.evaluations;
  }
  EXPECT_GT(sum, 9U * 5U);
  EXPECT_EQ(mapper.statistics().evaluations, sum);
}

TEST_P(MatcherDrive, HasTheSameBitsOnEveryInstructionSetAndWithTwoThreads) {
  const std::vector<DriveScan> scans = drifting(room_scans(24, 2));
  const MapperConfig config = quick_config(GetParam());
  const auto baseline = make_cpu_backend({.threads = 1, .isa = Isa::kBaseline});
  const MappedDrive expected = map_drive(scans, config, *baseline);
  for (const Isa isa : available_isas()) {
    for (const unsigned threads : {1U, 2U}) {
      const auto backend = make_cpu_backend({.threads = threads, .isa = isa});
      SCOPED_TRACE(std::string(to_string(isa)) + ", " + std::to_string(threads));
      expect_same(map_drive(scans, config, *backend), expected);
    }
  }
}

std::vector<MatcherKind> all_kinds() {
  std::vector<MatcherKind> kinds;
  for (const MatcherInfo& matcher : matchers()) kinds.push_back(matcher.kind);
  return kinds;
}

std::string name_of_kind(const testing::TestParamInfo<MatcherKind>& kind) {
  std::string name(to_string(kind.param));
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, MatcherDrive, testing::ValuesIn(all_kinds()), name_of_kind);

// What the page says of it is a row of its own.
TEST(Matchers, EachHasItsRowAndItsName) {
  EXPECT_EQ(matchers().size(), matcher_names().size());
  for (const MatcherInfo& matcher : matchers()) {
    EXPECT_EQ(&matcher_info(matcher.kind), &matcher);
    EXPECT_EQ(matcher.name, matcher_names()[static_cast<std::size_t>(matcher.kind)]);
    EXPECT_FALSE(matcher.doc.empty()) << matcher.name;
    EXPECT_EQ(matcher.descend == nullptr, matcher.follows_slope) << matcher.name;
  }
}

}  // namespace
}  // namespace gdtslam::test
