// Why a scan counts as not found, from made-up results whose reason is plain; and what many add up to.
#include "engine/runs/localizer/figures.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string_view>

namespace gdtslam {
namespace {

CertifiedResult result_of(double mean_cost_m, CertifiedStop stop = CertifiedStop::kGapReached) {
  CertifiedResult result;
  result.mean_cost_m = mean_cost_m;
  result.stop = stop;
  return result;
}

// Found at 20 mm mean distance, 2 m from the reference, whose surroundings cost 30 mm.
LocalizedScan scan_off() {
  LocalizedScan scan;
  scan.has_returns = true;
  scan.points = 180;
  scan.best = result_of(0.020);
  ReferencePose reference;
  reference.distance_m = 2.0;
  reference.known_share = 1.0;
  reference.nearby = result_of(0.030);
  scan.reference = reference;
  return scan;
}

constexpr LocalizeLimits kLimits{};

TEST(LocalizeFault, NoneWithinTheLimits) {
  LocalizedScan scan = scan_off();
  scan.reference->is_within = true;
  scan.reference->nearby.reset();
  EXPECT_EQ(fault_of(scan, kLimits), LocalizeFault::kNone);
}

TEST(LocalizeFault, MapPrefersWhereTheReferenceCostsMoreThanTheGap) {
  LocalizedScan scan = scan_off();
  EXPECT_EQ(fault_of(scan, kLimits), LocalizeFault::kMapPrefers);
  scan.best->stop = CertifiedStop::kTimeLimit;  // a longer search could only have found what costs less still
  EXPECT_EQ(fault_of(scan, kLimits), LocalizeFault::kMapPrefers);
}

TEST(LocalizeFault, AsGoodUpToTheGapOnEitherSide) {
  LocalizedScan scan = scan_off();
  for (const double nearby_m : {0.0151, 0.020, 0.0249}) {
    scan.reference->nearby->mean_cost_m = nearby_m;
    EXPECT_EQ(fault_of(scan, kLimits), LocalizeFault::kAsGood) << nearby_m;
  }
  scan.reference->nearby->mean_cost_m = 0.0251;
  EXPECT_EQ(fault_of(scan, kLimits), LocalizeFault::kMapPrefers);
}

TEST(LocalizeFault, NotProvenWhereASearchWasCutShort) {
  LocalizedScan scan = scan_off();
  scan.best->stop = CertifiedStop::kBoxLimit;
  scan.reference->nearby->mean_cost_m = 0.010;
  EXPECT_EQ(fault_of(scan, kLimits), LocalizeFault::kNotProven);
  scan.best.reset();
  EXPECT_EQ(fault_of(scan, kLimits), LocalizeFault::kNotProven);
  scan = scan_off();
  scan.reference->nearby.reset();
  EXPECT_EQ(fault_of(scan, kLimits), LocalizeFault::kNotProven);
}

TEST(LocalizeFault, NoOverlapWhereTheMapHasLittleOfTheScan) {
  LocalizedScan scan = scan_off();
  scan.reference->known_share = 0.49;
  EXPECT_EQ(fault_of(scan, kLimits), LocalizeFault::kNoOverlap);
  scan.reference->known_share = 0.51;
  EXPECT_EQ(fault_of(scan, kLimits), LocalizeFault::kMapPrefers);
}

TEST(LocalizeFault, TooFewReturnsComesFirst) {
  LocalizedScan scan = scan_off();
  scan.has_returns = false;
  scan.best.reset();
  scan.reference->known_share = 0.0;
  EXPECT_EQ(fault_of(scan, kLimits), LocalizeFault::kTooFewReturns);
}

TEST(LocalizeFault, EveryOneHasItsNameAndWords) {
  std::set<std::string_view> names{to_string(LocalizeFault::kNone)};
  std::set<std::string_view> words{as_text(LocalizeFault::kNone)};
  for (const LocalizeFault fault : kLocalizeFaults) {
    EXPECT_TRUE(names.insert(to_string(fault)).second) << to_string(fault);
    EXPECT_TRUE(words.insert(as_text(fault)).second) << as_text(fault);
  }
  EXPECT_EQ(to_string(LocalizeFault::kAsGood), "as-good");
  EXPECT_EQ(as_text(LocalizeFault::kAsGood), "both poses fit alike");
}

TEST(LocalizeVerdict, IsOfTheFitAndThePosesElsewhere) {
  LocalizedScan scan = scan_off();  // 20 mm
  EXPECT_EQ(verdict_of(scan, 0.02), Verdict::kFound);
  EXPECT_EQ(verdict_of(scan, 0.0199), Verdict::kPoorFit);
  scan.best->stop = CertifiedStop::kTimeLimit;  // the proof is another matter
  EXPECT_EQ(verdict_of(scan, 0.02), Verdict::kFound);
  scan.best->cost = 100;
  scan.runner_up = result_of(0.021);
  scan.runner_up->bound = 101;
  EXPECT_EQ(verdict_of(scan, 0.02), Verdict::kFound);
  scan.as_good = 1;
  EXPECT_EQ(verdict_of(scan, 0.02), Verdict::kAmbiguous);
  EXPECT_EQ(verdict_of(scan, 0.01), Verdict::kPoorFit) << "wherever else it may fit as poorly";
  scan.best.reset();
  EXPECT_EQ(verdict_of(scan, 1.0), Verdict::kNoPose);
}

TEST(LocalizeVerdict, WordsLeaveOutOnlyWhatIsRare) {
  EXPECT_EQ(as_text({196, 4, 0, 0}), "196 found, 4 ambiguous, 0 poor fit");
  EXPECT_EQ(as_text({0, 0, 2, 1}), "0 found, 0 ambiguous, 2 poor fit, 1 no pose");
}

TEST(LocalizeFigures, CountsAddUp) {
  LocalizedScan right = scan_off();
  right.reference->is_within = true;
  right.reference->distance_m = 0.03;
  LocalizedScan without_reference = scan_off();
  without_reference.reference.reset();
  LocalizedScan empty = scan_off();
  empty.has_returns = false;
  empty.best.reset();
  LocalizedScan ambiguous = right;
  ambiguous.runner_up = result_of(0.021);
  ambiguous.runner_up->bound = 90;
  ambiguous.best->cost = 100;
  right.verdict = Verdict::kFound;
  ambiguous.verdict = Verdict::kAmbiguous;
  without_reference.verdict = Verdict::kPoorFit;
  const LocalizeFigures figures = figures_of({right, scan_off(), without_reference, empty, ambiguous}, kLimits);
  EXPECT_EQ(figures.certified, 4U);
  EXPECT_EQ(figures.verdicts, (std::array<std::uint64_t, 4>{1, 1, 1, 2}));
  EXPECT_EQ(figures.within.count, 2U);
  EXPECT_EQ(figures.within.of, 4U);
  EXPECT_EQ(figures.faults, (std::array<std::uint64_t, 5>{1, 0, 0, 0, 1}));
  EXPECT_EQ(figures.distance_m.count, 2U);
  EXPECT_DOUBLE_EQ(figures.distance_m.mean, 0.03);
}

}  // namespace
}  // namespace gdtslam
