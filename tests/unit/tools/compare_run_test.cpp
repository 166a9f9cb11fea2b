// The minimisers compared on maps that follow each other.
#include <gtest/gtest.h>

#include <memory>

#include "support/sample_log.hpp"
#include "tools/lab/matchers/run.hpp"

namespace gdtslam {
namespace {

// Each scan is measured in the map that it is then matched with, though that of the scan before is gone: from the
// prediction as from the search with proof a method comes to the bottom of the same valley.
TEST(CompareRun, LocalMapsThatTakeEachOthersPlace) {
  CompareJob job;
  job.logs = {test::kSampleLog + ".log.gz"};
  job.range.count = 200;
  job.mapper.local.stretch_m = 2.0;
  job.methods = {MatcherKind::kGaussNewton};
  job.scans = 20;
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  const CompareOutcome outcome = compare(
      job, *cpu, [](std::uint64_t, double) {}, [] { return false; });
  ASSERT_GE(outcome.scans.size(), 15U);
  ASSERT_EQ(outcome.trials.size(), outcome.scans.size());
  std::size_t successes = 0;
  for (std::size_t k = 0; k < outcome.scans.size(); ++k) {
    EXPECT_GE(outcome.scans[k].mean_cost_m, outcome.scans[k].mean_bound_m) << outcome.scans[k].index;
    successes += outcome.trials[k].is_success() ? 1U : 0U;
  }
  EXPECT_GE(successes + 2, outcome.scans.size());
}

}  // namespace
}  // namespace gdtslam
