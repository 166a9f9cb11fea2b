// The default configuration on real logs, without loop closure: mean errors of the relations of [Kuemmerle2009],
// processor time, and that a wrong merge rule shows. Skipped, visibly, where the logs are not there.
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include <gtest/gtest.h>

#include "gdtslam/io/log.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {
namespace {

struct RealLog {
  const char* name;
  MatcherKind matcher;
  double max_translation_m;
  double max_rotation_deg;
  double max_error_m;  // of the worst relation
};

void PrintTo(const RealLog& log, std::ostream* out) { *out << log.name; }

std::string stem_of(const char* name) {
  const char* const folder = std::getenv("GDTSLAM_DATA");
  const std::filesystem::path root =
      folder != nullptr ? std::filesystem::path(folder) : std::filesystem::path(GDTSLAM_SOURCE_DIR) / "../shared/data";
  return (root / "slam2d" / name).string();
}

struct Outcome {
  RelationReport report;
  MapperStatistics statistics;
  double cpu_s = 0.0;
};

// Every `step`-th scan of a log.
Outcome map_log(const std::string& stem, const MapperConfig& config, std::size_t step = 1) {
  const std::clock_t start = std::clock();
  const auto backend = make_cpu_backend({});
  Mapper mapper(config, *backend);
  Trajectory trajectory;
  const auto reader = open_log(stem + ".clf.gz", {});
  std::size_t scans = 0;
  while (const auto record = reader->next()) {
    const auto* const scan = std::get_if<ScanRecord>(&*record);
    if (scan == nullptr || ++scans % step != 0) continue;
    const MatchResult result = mapper.process(scan->scan, scan->T_odom_base);
    trajectory.push_back({result.stamp_s, result.T_map_base});
  }
  const double cpu_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return {evaluate_relations(trajectory, read_relations(stem + ".relations.gz")), mapper.statistics(), cpu_s};
}

class RealLogTest : public testing::TestWithParam<RealLog> {};

TEST_P(RealLogTest, MapsWithinTheBoundsInUnderTenSecondsOfProcessorTime) {
  const std::string stem = stem_of(GetParam().name);
  if (!std::filesystem::exists(stem + ".clf.gz")) GTEST_SKIP() << "no " << stem << ".clf.gz; set GDTSLAM_DATA";
  MapperConfig config;
  config.match.matcher = GetParam().matcher;
  const Outcome run = map_log(stem, config);
  EXPECT_EQ(run.report.unmatched, 0U);
  EXPECT_LE(run.report.all.translation_m.mean, GetParam().max_translation_m);
  EXPECT_LE(run.report.all.rotation_deg.mean, GetParam().max_rotation_deg);
  EXPECT_LE(run.report.all.translation_m.max, GetParam().max_error_m) << "a wrong jump hides in the mean";
  EXPECT_EQ(run.statistics.restarts, 0U);
#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(run.cpu_s, 10.0);
#endif
}

constexpr MatcherKind kDefault = MatchConfig{}.matcher;
constexpr MatcherKind kExhaustive = MatcherKind::kExhaustive;
constexpr MatcherKind kGaussNewton = MatcherKind::kGaussNewton;
std::string suffix_of(MatcherKind matcher) {
  if (matcher == kDefault) return "";
  return matcher == kGaussNewton ? "_gauss_newton" : "_exhaustive";
}

INSTANTIATE_TEST_SUITE_P(Logs, RealLogTest,
                         testing::Values(RealLog{"intel", kDefault, 0.030, 0.40, 0.25},
                                         RealLog{"fr079", kDefault, 0.035, 0.50, 0.25},
                                         RealLog{"mit-csail", kDefault, 0.035, 0.45, 0.35},
                                         RealLog{"intel", kExhaustive, 0.030, 0.40, 0.30},
                                         RealLog{"intel", kGaussNewton, 0.035, 0.40, 0.50},
                                         RealLog{"fr079", kGaussNewton, 0.045, 0.50, 0.60},
                                         RealLog{"mit-csail", kGaussNewton, 0.035, 0.45, 0.35},
                                         RealLog{"fr079", kExhaustive, 0.035, 0.50, 0.25},
                                         RealLog{"mit-csail", kExhaustive, 0.035, 0.45, 0.35}),
                         [](const auto& log) {
                           const std::string name = log.param.name;
                           return (name == "mit-csail" ? "csail" : name) + suffix_of(log.param.matcher);
                         });

// At half its rate the step of 85 degrees in CSAIL's odometry lies where little of the map is known, and somewhere else
// in the building looks better.
TEST(RealLogThinned, EverySecondScanOfCsailIsMappedByEveryMatcher) {
  const std::string stem = stem_of("mit-csail");
  if (!std::filesystem::exists(stem + ".clf.gz")) GTEST_SKIP() << "no " << stem << ".clf.gz; set GDTSLAM_DATA";
  for (const MatcherKind matcher : {kDefault, kExhaustive}) {
    for (const std::int32_t starts : {3, 7}) {
      MapperConfig config;
      config.match.matcher = matcher;
      config.search.starts = starts;
      const Outcome run = map_log(stem, config, 2);
      EXPECT_LE(run.report.all.translation_m.mean, 0.035) << starts;
      EXPECT_LE(run.report.all.translation_m.max, 0.35) << starts;
    }
  }
}

TEST(RealLogRule, TheMergeRuleAsPrintedMissesTheBoundOnIntel) {
  const std::string stem = stem_of("intel");
  if (!std::filesystem::exists(stem + ".clf.gz")) GTEST_SKIP() << "no " << stem << ".clf.gz; set GDTSLAM_DATA";
  MapperConfig config;
  config.merge.rule = MergeRule::kLiteral;
  config.search.attempts = 1;  // all is lost anyway, and soon
  EXPECT_GT(map_log(stem, config).report.all.translation_m.mean, 0.3);
}

}  // namespace
}  // namespace gdtslam
