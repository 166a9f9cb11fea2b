// Which stretches of a path a report says are not to be trusted.
#include "engine/runs/folder/loop_files.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vector>

namespace gdtslam {
namespace {

// One covariance a pose, as sure as that along its worse axis, which lies across the map's axes.
std::vector<PoseCovariance> covariances_of(const std::vector<double>& sigmas_m) {
  std::vector<PoseCovariance> covariances;
  for (const double sigma_m : sigmas_m) {
    const double worse = sigma_m * sigma_m;
    const double better = 0.0001;
    covariances.push_back({.xx = 0.5 * (worse + better), .xy = 0.5 * (worse - better), .yy = 0.5 * (worse + better)});
  }
  return covariances;
}

TEST(LoopsReport, SigmaIsThatOfTheWorstDirection) {
  EXPECT_NEAR(covariances_of({0.3}).front().sigma_m(), 0.3, 1.0e-12);
  EXPECT_EQ((PoseCovariance{.xx = 0.04, .yy = 0.09}.sigma_m()), 0.3);
}

TEST(LoopsReport, NeighboursThatAreUnsureAreOneStretch) {
  const std::vector<UncertainStretch> stretches =
      uncertain_stretches(covariances_of({0.25, 0.05, 0.21, 0.4, 0.3, 0.19, 0.02, 0.5}));
  ASSERT_EQ(stretches.size(), 3U);
  EXPECT_EQ(stretches[0].from, 0U);
  EXPECT_EQ(stretches[0].to, 0U);
  EXPECT_EQ(stretches[1].from, 2U);
  EXPECT_EQ(stretches[1].to, 4U);
  EXPECT_NEAR(stretches[1].sigma_m, 0.4, 1.0e-12);
  EXPECT_EQ(stretches[2].from, 7U);
  EXPECT_EQ(stretches[2].to, 7U);
  EXPECT_TRUE(uncertain_stretches(covariances_of({0.1, 0.0, 0.199})).empty());
  EXPECT_TRUE(uncertain_stretches({}).empty());
}

TEST(LoopsReport, CountsTheScansOfAllStretches) {
  ClosedPath closed;
  closed.covariances = covariances_of({0.1, 0.25, 0.3, 0.1, 0.6});
  const Trajectory trajectory{{10.0, {}}, {11.0, {}}, {12.5, {}}, {13.0, {}}, {14.0, {}}};
  const nlohmann::ordered_json json = uncertain_json(closed, trajectory);
  EXPECT_EQ(json["scans"], 3);
  ASSERT_EQ(json["stretches"].size(), 2U);
  EXPECT_EQ(json["stretches"][0]["from_s"], 11.0);
  EXPECT_EQ(json["stretches"][0]["to_s"], 12.5);
  EXPECT_NEAR(json["sigma_median_m"].get<double>(), 0.25, 1.0e-12);
  EXPECT_NEAR(json["sigma_max_m"].get<double>(), 0.6, 1.0e-12);
}

}  // namespace
}  // namespace gdtslam
