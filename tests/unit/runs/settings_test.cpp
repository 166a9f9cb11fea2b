// What a log's settings allow and what of them a reader is told.
#include "gdtslam/runs/settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::vector<std::string> faults_after(const std::function<void(LogConfig&)>& change) {
  LogConfig config;
  change(config);
  return find_faults(config);
}

TEST(LogSettings, AsTheyAreThereIsNoFault) { EXPECT_THAT(find_faults(LogConfig{}), IsEmpty()); }

TEST(LogSettings, EachValueThatNothingWouldUseIsAFault) {
  using Change = std::function<void(LogConfig&)>;
  const std::vector<std::pair<const char*, Change>> rows{
      {"log.mount: stated", [](LogConfig& c) { c.T_base_laser.x_m = -0.1; }},
      {"log.mount: stated", [](LogConfig& c) { c.T_base_laser.y_m = 0.1; }},
      {"log.mount: stated", [](LogConfig& c) { c.T_base_laser.theta_rad = 0.1; }},
      {"log.bearings: stated", [](LogConfig& c) { c.first_bearing_rad = -0.1; }},
      {"log.bearings: stated", [](LogConfig& c) { c.bearing_step_rad = 0.1; }},
      {"log.beam_times: stated", [](LogConfig& c) { c.first_beam_after_s = -0.1; }},
      {"log.beam_times: stated", [](LogConfig& c) { c.beam_period_s = 0.1; }},
      {"log.odometry_stamps: stated", [](LogConfig& c) { c.odometry_delay_s = -0.1; }},
      {"log.clock: stated", [](LogConfig& c) { c.clock_offset_s = 0.1; }},
      {"log.crank: tilt", [](LogConfig& c) { c.crank.zero = 5.0; }}};
  for (const auto& [words, change] : rows) EXPECT_THAT(faults_after(change), ElementsAre(HasSubstr(words)));
}

TEST(LogSettings, WhatIsStatedIsNoFault) {
  EXPECT_THAT(faults_after([](LogConfig& c) {
                c.mount = c.bearings = c.beam_times = c.clock = LogSource::kStated;
                c.odometry_stamps = OdometryStamps::kStated;
                c.crank.kind = CrankKind::kTilt;
                c.T_base_laser = {0.1, 0.2, 0.3};
                c.first_bearing_rad = c.bearing_step_rad = 0.1;
                c.first_beam_after_s = c.beam_period_s = 0.1;
                c.odometry_delay_s = c.clock_offset_s = c.crank.zero = 0.1;
              }),
              IsEmpty());
  EXPECT_THAT(faults_after([](LogConfig& c) { c.bearings = LogSource::kStated; }),
              ElementsAre(HasSubstr("need a step that is not 0")));
  EXPECT_THAT(faults_after([](LogConfig& c) { c.odometry_stamps = OdometryStamps::kLog; }), IsEmpty());
}

TEST(LogSettings, OnlyWhatIsStatedIsToldToTheReader) {
  LogConfig config;
  config.T_base_laser = {0.1, 0.2, 0.3};
  config.first_bearing_rad = -1.5;
  config.bearing_step_rad = 0.01;
  config.first_beam_after_s = 0.001;
  config.beam_period_s = 0.002;
  config.clock_offset_s = 7.0;
  config.deskew = false;
  const ReadOptions as_logged = read_options_of(config, false);
  EXPECT_FALSE(as_logged.lenient);
  EXPECT_FALSE(as_logged.T_base_laser || as_logged.first_bearing_rad || as_logged.bearing_step_rad);
  EXPECT_FALSE(as_logged.first_beam_after_s || as_logged.beam_period_s || as_logged.clock_offset_s);
  EXPECT_FALSE(as_logged.max_range_m || as_logged.all_lasers || as_logged.deskew);
  config.mount = config.bearings = config.beam_times = config.clock = LogSource::kStated;
  config.lasers = LogLasers::kAll;
  config.max_range_m = 0.5;
  config.deskew = true;
  const ReadOptions stated = read_options_of(config, true);
  EXPECT_TRUE(stated.lenient && stated.all_lasers && stated.deskew);
  EXPECT_TRUE(stated.T_base_laser == (Pose2{0.1, 0.2, 0.3}));
  EXPECT_EQ(stated.first_bearing_rad, -1.5);
  EXPECT_EQ(stated.bearing_step_rad, 0.01);
  EXPECT_EQ(stated.first_beam_after_s, 0.001);
  EXPECT_EQ(stated.beam_period_s, 0.002);
  EXPECT_EQ(stated.clock_offset_s, 7.0);
  EXPECT_EQ(stated.max_range_m, 0.5);
}

TEST(LogSettings, EveryFaultIsNamedAtOnce) {
  Settings settings;
  EXPECT_NO_THROW(require_valid(settings));
  settings.nod_limits.max_gap_s = 0.0005;
  settings.log.clock_offset_s = 1.0;
  settings.mapper.scan.min_range_m = -1.0;
  try {
    require_valid(settings);
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("scan.min_range"));
    EXPECT_THAT(error.what(), HasSubstr("; nod.max_gap"));
    EXPECT_THAT(error.what(), HasSubstr("; log.clock_offset"));
    EXPECT_THAT(error.what(), Not(testing::StartsWith("; ")));
  }
}

}  // namespace
}  // namespace gdtslam
