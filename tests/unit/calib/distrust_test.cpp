// Which results of a calibration are refused, at the limits that calibration.hpp states, and that a fit to a sweep that
// is not the mount's is one of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "gdtslam/calib/calibration.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

CalibrationResult good() {
  CalibrationResult result;
  result.converged = true;
  result.observations = 90;
  result.residual_rms = 1.0;
  result.all_rms = 1.0;
  result.parameters = {{.name = "crank", .unit = "m"}, {.name = "zero", .unit = "rad"}};
  return result;
}

TEST(ReasonForDistrust, BarOnItsBoundThatDoesNotFit) {
  CalibrationResult result = good();
  result.all_rms = 12.34;
  EXPECT_THAT(reason_for_distrust(result), IsEmpty());
  result.parameters[1].at_bound = true;
  EXPECT_THAT(reason_for_distrust(result), IsEmpty()) << "the zero is no bar";
  result.parameters[0].at_bound = true;
  EXPECT_THAT(reason_for_distrust(result), AllOf(HasSubstr("crank lies on its bound"), HasSubstr("12.3 sigma")));
  result.all_rms = 2.9;
  EXPECT_THAT(reason_for_distrust(result), IsEmpty()) << "it fits";
  result.all_rms = std::numeric_limits<double>::infinity();
  EXPECT_THAT(reason_for_distrust(result), HasSubstr("crank lies on its bound"));
}

// A motor that sweeps the laser to and fro evenly is no linkage of any lengths near those of the start: the ranges
// that did fit must not speak for the others.
TEST(ReasonForDistrust, SweepOfAnotherMount) {
  const SweepModel start = sweep_model_of_preset("paper-b");
  std::vector<RangeObservation> seen;
  for (int stop = 0; stop < 200; ++stop) {
    const double turn = stop / 200.0;
    const double elevation = rad_from_deg(50.0) * (4.0 * std::fabs(turn - 0.5) - 1.0);
    seen.push_back({.ticks = 20000.0 * turn, .range_m = 2.0 / std::cos(elevation), .sigma_m = 0.001});
  }
  const CalibrationResult result = calibrate(start, {{.name = "wall", .distance_m = 2.0}}, seen, {});
  EXPECT_THAT(reason_for_distrust(result), testing::Not(IsEmpty()));
  EXPECT_GT(result.all_rms, 10.0);
}

}  // namespace
}  // namespace gdtslam::calib
