// Which parameters a calibration has, and what a step of each means.
#include "calib/calibration/parameters.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

using testing::ElementsAre;

Setup wall_and_ceiling() {
  CalibrationSurface wall{.name = "wall", .distance_m = 2.0, .heading_rad = 0.1};
  wall.distance_known = wall.heading_known = false;
  CalibrationSurface ceiling{.name = "ceiling", .kind = SurfaceKind::kCeiling, .distance_m = 1.5};
  ceiling.distance_known = ceiling.heading_known = false;
  return {sweep_model_of_preset("paper-b"), {wall, ceiling}};
}

std::vector<std::string> names_of(const std::vector<Parameter>& parameters) {
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) names.push_back(parameter.name);
  return names;
}

TEST(CalibrationParameters, AreThoseThatAreFree) {
  calib::Setup start = wall_and_ceiling();
  CalibrationOptions options;
  EXPECT_THAT(names_of(make_parameters(start, options)),
              ElementsAre("crank", "coupler", "rocker", "ground", "zero", "offset", "distance.wall", "heading.wall",
                          "distance.ceiling"));
  start.surfaces[0].distance_known = true;
  start.surfaces[1].distance_known = true;
  options.free_lever = true;
  EXPECT_THAT(names_of(make_parameters(start, options)),
              ElementsAre("crank", "coupler", "rocker", "ground", "zero", "offset", "lever.forward", "lever.up",
                          "heading.wall"));
  start.surfaces[0].heading_known = true;
  options.free_lever = false;
  options.free_sensor_angles = true;
  EXPECT_THAT(names_of(make_parameters(start, options)),
              ElementsAre("crank", "coupler", "rocker", "ground", "zero", "offset", "sensor.roll", "sensor.yaw"));
}

TEST(CalibrationParameters, AreScaledByTheirPriorAndKeptWithinTheirBound) {
  CalibrationOptions options{.bar_bound_m = 0.007,
                             .bar_prior_m = 0.001,
                             .zero_prior_rad = 0.02,
                             .offset_prior_rad = 0.03,
                             .distance_prior_m = 0.04,
                             .lever_prior_m = 0.05,
                             .angle_prior_rad = 0.06,
                             .free_lever = true,
                             .free_sensor_angles = true};
  const calib::Setup start = wall_and_ceiling();
  const std::vector<double> priors{0.001, 0.001, 0.001, 0.001, 0.02, 0.03, 0.05, 0.05, 0.06, 0.06, 0.04, 0.06, 0.04};
  const std::vector<double> bounds{0.007, 0.007,   0.007,   0.007, kPi,     0.5 * kPi, 0.2,
                                   0.2,   kPi / 4, kPi / 4, 0.5,   kPi / 4, 0.5};
  const std::vector<Parameter> held = make_parameters(start, options);
  const std::vector<Parameter> free = make_parameters(start, options.without_priors());
  ASSERT_EQ(held.size(), priors.size());
  ASSERT_EQ(free.size(), priors.size());
  for (std::size_t k = 0; k < held.size(); ++k) {
    EXPECT_EQ(held[k].prior_sigma, priors[k]) << held[k].name;
    EXPECT_EQ(held[k].scale, priors[k]) << held[k].name;
    EXPECT_NEAR(held[k].bound_scaled(), bounds[k] / priors[k], 1e-9) << held[k].name;
    EXPECT_EQ(free[k].prior_sigma, 0.0) << free[k].name;
    EXPECT_GT(free[k].scale, 0.0) << free[k].name << ": without a prior it has the default's scale";
  }
  options.search_zero = true;
  EXPECT_EQ(make_parameters(start, options)[4].prior_sigma, 0.0) << "a zero that is searched for has no prior";
}

TEST(CalibrationParameters, AStepMovesItsOwnValueAlone) {
  const calib::Setup start = wall_and_ceiling();
  const std::vector<Parameter> parameters = make_parameters(start, {.free_lever = true, .free_sensor_angles = true});
  const auto values_of = [](const calib::Setup& setup) {
    const SweepModel& model = setup.model;
    return std::vector<double>{model.bars.crank_m,          model.bars.coupler_m,         model.bars.rocker_m,
                               model.bars.ground_m,         model.encoder.zero_rad,       model.elevation_offset_rad,
                               model.mount.lever_forward_m, model.mount.lever_up_m,       model.mount.sensor_roll_rad,
                               model.mount.sensor_yaw_rad,  setup.surfaces[0].distance_m, setup.surfaces[0].heading_rad,
                               setup.surfaces[1].distance_m};
  };
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    std::vector<double> x(parameters.size(), 0.0);
    x[k] = -0.5;
    std::vector<double> expected = values_of(start);
    expected[k] -= 0.5 * parameters[k].scale;
    EXPECT_EQ(values_of(setup_at(start, parameters, x)), expected) << parameters[k].name;
  }
}

// The loop closes at the far crank angle, at the near one, and has bars at all: the least of the three.
TEST(CalibrationParameters, ALoopHasTheRoomOfItsWorstAngle) {
  EXPECT_NEAR(closing_room_m({.crank_m = 0.03, .coupler_m = 0.08, .rocker_m = 0.09, .ground_m = 0.1}), 0.03, 1e-12);
  EXPECT_NEAR(closing_room_m({.crank_m = 0.03, .coupler_m = 0.08, .rocker_m = 0.06, .ground_m = 0.1}), 0.01, 1e-12);
  EXPECT_NEAR(closing_room_m({.crank_m = 0.03, .coupler_m = 0.05, .rocker_m = 0.1, .ground_m = 0.09}), 0.01, 1e-12);
  EXPECT_NEAR(closing_room_m({.crank_m = 0.03, .coupler_m = 0.1, .rocker_m = 0.05, .ground_m = 0.09}), 0.01, 1e-12);
  EXPECT_NEAR(closing_room_m({.crank_m = 0.06, .coupler_m = 0.05, .rocker_m = 0.09, .ground_m = 0.09}), -0.01, 1e-12);
}

}  // namespace
}  // namespace gdtslam::calib
