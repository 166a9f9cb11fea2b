// Self-calibration in worlds of two strokes whose points depend on one parameter in a straight line, so that what is
// paired, and what is found, follows by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "calib/calibration/self_calibration.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::calib {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const SweepModel kStart = sweep_model_of_preset("paper-b");

/// Ten points about an origin: the corners of a box, twice its middle.
std::vector<Point3> box_of(double x_m, double y_m, double z_m) {
  std::vector<Point3> points(2, Point3::Zero());
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      for (const double sz : {-1.0, 1.0}) points.emplace_back(sx * x_m, sy * y_m, sz * z_m);
    }
  }
  return points;
}

/// Points of the first stroke, each with neighbours of the second one, a metre from one to the next.
struct World {
  void add(std::size_t times, double height_m, double slope,
           const std::vector<Point3>& neighbours = box_of(0.1, 0.1, 0)) {
    for (std::size_t k = 0; k < times; ++k) {
      const Point3 origin(static_cast<double>(feet.size()), 0.0, 0.0);
      feet.push_back(origin);
      heights_m.push_back(height_m);
      slopes.push_back(slope);
      for (const Point3& beside : neighbours) around.push_back(origin + beside);
    }
  }
  [[nodiscard]] std::vector<std::uint32_t> strokes() const {
    std::vector<std::uint32_t> list(feet.size(), 0);
    list.resize(feet.size() + around.size(), 1);
    return list;
  }
  /// The points where the parameter is so far from its start.
  [[nodiscard]] std::vector<Point3> points(double change) const {
    std::vector<Point3> list = feet;
    for (std::size_t k = 0; k < list.size(); ++k) list[k].z() += heights_m[k] + slopes[k] * change;
    list.insert(list.end(), around.begin(), around.end());
    return list;
  }
  [[nodiscard]] SelfCalibrationResult calibrated(const SelfCalibrationOptions& options = {}) const {
    const auto assemble = [this](const SweepModel& model) {
      return points(model.encoder.zero_rad - kStart.encoder.zero_rad);
    };
    return self_calibrate(kStart, strokes(), assemble, options);
  }
  std::vector<Point3> feet;
  std::vector<double> heights_m;
  std::vector<double> slopes;  ///< metres a radian
  std::vector<Point3> around;
};

const CalibratedParameter& zero_of(const SelfCalibrationResult& result) { return result.parameters.at(4); }

/// How many of these are paired beside a hundred that are.
std::uint32_t paired(const World& world, const SelfCalibrationOptions& options = {}) {
  World whole = world;
  whole.add(100, 0.0, 1.0);
  return whole.calibrated(options).pairs - 100;
}

TEST(SelfCalibrate, WeighsTheMissesAgainstThePrior) {
  constexpr double kOff_rad = 0.05;
  for (const double sigma_m : {0.01, 0.2}) {
    World world;
    world.add(200, -kOff_rad, 1.0);
    SelfCalibrationOptions options;
    options.sigma_m = sigma_m;
    const SelfCalibrationResult result = world.calibrated(options);
    const double prior_rad = options.priors.zero_prior_rad;
    const double by_data = 200.0 / (sigma_m * sigma_m);
    const double share = by_data / (by_data + 1.0 / (prior_rad * prior_rad));
    EXPECT_TRUE(result.converged);
    EXPECT_EQ(reason_for_distrust(result), "");
    EXPECT_EQ(result.pairs, 200U);
    EXPECT_EQ(zero_of(result).name, "zero");
    EXPECT_NEAR(zero_of(result).estimate - zero_of(result).start, share * kOff_rad, 1e-9);
    EXPECT_NEAR(result.model.encoder.zero_rad - kStart.encoder.zero_rad, share * kOff_rad, 1e-9);
    EXPECT_NEAR(zero_of(result).sigma, std::sqrt(1.0 - share) * prior_rad, 1e-9);
    EXPECT_NEAR(zero_of(result).data_share, share, 1e-6);
    EXPECT_NEAR(result.median_miss_before_m, kOff_rad, 1e-12);
    EXPECT_NEAR(result.median_miss_m, (1.0 - share) * kOff_rad, 1e-9);
    EXPECT_THAT(result.remarks, ElementsAre(HasSubstr("hardly tell crank, coupler, rocker, ground, offset:")));
    EXPECT_EQ(result.model.bars.crank_m, kStart.bars.crank_m);
  }
}

TEST(SelfCalibrate, ABarStopsAtItsBound) {
  World world;
  world.add(200, -0.06, 10.0);  // as if it were 6 mm longer
  SelfCalibrationOptions options;
  options.priors.bar_prior_m = 0.01;
  for (const double sign : {-1.0, 1.0}) {
    const auto assemble = [&](const SweepModel& model) {
      return world.points(sign * (model.bars.crank_m - kStart.bars.crank_m));
    };
    const SelfCalibrationResult result = self_calibrate(kStart, world.strokes(), assemble, options);
    EXPECT_NEAR(result.model.bars.crank_m - kStart.bars.crank_m, sign * 0.005, 1e-12);
    EXPECT_TRUE(result.parameters.at(0).at_bound);
    ASSERT_FALSE(result.remarks.empty());
    EXPECT_EQ(result.remarks.front(), "crank lies on its bound");
  }
}

TEST(SelfCalibrate, AHundredPairsAreNeeded) {
  World world;
  world.add(99, 0.0, 1.0);
  try {
    static_cast<void>(world.calibrated());
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("only 99 points of a stroke"));
    EXPECT_THAT(error.what(), HasSubstr("100 are needed"));
  }
  world.add(1, 0.0, 1.0);
  EXPECT_EQ(world.calibrated().pairs, 100U);
}

TEST(SelfCalibrate, NeighboursAreAFlatPieceOfSurface) {
  World flat;  // a fiftieth of the variance along it is what a surface may have across
  flat.add(3, 0.0, 0.0, box_of(0.1, 0.1, 0.0140));
  flat.add(2, 0.0, 0.0, box_of(0.1, 0.1, 0.0143));
  EXPECT_EQ(paired(flat), 3U);
  World wide;  // 0.8 of the square of the half width is the variance
  wide.add(3, 0.0, 0.0, box_of(0.1, 0.0170, 0.0));
  wide.add(2, 0.0, 0.0, box_of(0.1, 0.0165, 0.0));
  EXPECT_EQ(paired(wide), 3U);
}

}  // namespace
}  // namespace gdtslam::calib
