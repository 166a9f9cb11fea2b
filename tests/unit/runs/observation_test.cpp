// Which scans of several lasers are one observation: expected values follow from the stamps of lasers with steady
// rates.
#include "engine/runs/streams/scan_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace gdtslam {
namespace {

using testing::ElementsAre;

struct Fired {
  double stamp_s;
  std::size_t laser;
};

ScanRecord fired_scan(const Fired& fired) {
  ScanRecord record;
  record.scan.stamp_s = fired.stamp_s;
  record.laser = fired.laser;
  return record;
}

/// Lasers by their numbers, as "01" for one observation of both, as far as they are complete before the next scan.
std::vector<std::string> observations(const std::vector<Fired>& scans, bool at_end = false) {
  ObservationCollector collector;
  std::vector<std::string> all;
  const auto collect = [&](bool is_end) {
    while (const std::optional<Observation> observation = collector.next(is_end)) {
      all.emplace_back();
      for (const ScanRecord& scan : *observation) all.back() += std::to_string(scan.laser);
    }
  };
  for (const Fired& fired : scans) {
    collector.take(fired_scan(fired));
    collect(false);
  }
  if (at_end) collect(true);
  return all;
}

/// Laser k fires at first_s[k] and every tenth of a second from then on.
std::vector<Fired> steady(const std::vector<double>& first_s, int periods) {
  std::vector<Fired> scans;
  for (int period = 0; period < periods; ++period) {
    for (std::size_t laser = 0; laser < first_s.size(); ++laser) {
      scans.push_back({first_s[laser] + 0.1 * period, laser});
    }
  }
  std::stable_sort(scans.begin(), scans.end(), [](const Fired& a, const Fired& b) { return a.stamp_s < b.stamp_s; });
  return scans;
}

TEST(ObservationCollector, EachScanOfOneLaserIsAnObservationAtOnce) {
  EXPECT_THAT(observations(steady({0.0}, 4)), ElementsAre("0", "0", "0", "0"));
}

TEST(ObservationCollector, LasersThatTakeTurnsAreTogether) {
  EXPECT_THAT(observations(steady({0.0, 0.05}, 4)), ElementsAre("0", "10", "10", "10"));
  EXPECT_THAT(observations(steady({0.0, 0.05}, 4), true), ElementsAre("0", "10", "10", "10", "1"));
}

TEST(ObservationCollector, ScansThatAreCloseInTimeStayTogether) {
  EXPECT_THAT(observations(steady({0.0, 0.01}, 5)), ElementsAre("0", "10", "1", "01", "01", "01"));
  EXPECT_THAT(observations(steady({0.0, 0.0}, 5)), ElementsAre("0", "10", "1", "01", "01", "01"));
  EXPECT_THAT(observations(steady({0.0, 0.01, 0.03}, 5)), ElementsAre("0", "120", "12", "012", "012", "012"));
}

TEST(ObservationCollector, ALaserThatStopsHoldsNothingUp) {
  std::vector<Fired> scans = steady({0.0, 0.05}, 4);
  for (int k = 4; k < 12; ++k) scans.push_back({0.1 * k, 0});
  const std::vector<std::string> all = observations(scans);
  ASSERT_EQ(all.size(), 12U);
  EXPECT_EQ(all[4], "10");
  for (std::size_t k = 5; k < all.size(); ++k) EXPECT_EQ(all[k], "0");
}

TEST(ObservationCollector, ASlowLaserJoinsAFastOne) {
  std::vector<Fired> scans;
  for (int k = 0; k < 12; ++k) {
    scans.push_back({0.025 * k, 0});
    if (k % 4 == 3) scans.push_back({0.025 * k + 0.012, 1});
  }
  EXPECT_THAT(observations(scans), ElementsAre("0", "0", "0", "0", "10", "0", "0", "01", "0", "0", "0", "01"));
}

// A column of numbers that never repeat, taken for lasers.
TEST(ObservationCollector, NoObservationLastsLong) {
  std::vector<Fired> scans;
  for (std::size_t k = 0; k < 100; ++k) scans.push_back({0.1 * static_cast<double>(k), k});
  for (const std::string& observation : observations(scans)) EXPECT_LE(observation.size(), 22U) << observation;
  for (Fired& scan : scans) scan.stamp_s = 0.0;
  EXPECT_GE(observations(scans, true).size(), 2U);
}

TEST(ObservationCollector, AnObservationLiesInOneLog) {
  ObservationCollector collector;
  for (const Fired& fired : steady({0.0, 0.05}, 2)) collector.take(fired_scan(fired));
  collector.end_log();
  collector.take(fired_scan({0.2, 0}));
  std::vector<std::size_t> sizes;
  while (const std::optional<Observation> observation = collector.next(false)) sizes.push_back(observation->size());
  EXPECT_THAT(sizes, ElementsAre(1, 2, 1, 1));
}

}  // namespace
}  // namespace gdtslam
