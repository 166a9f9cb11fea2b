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

TEST(LogSettings, AngleTimeAndLengthHaveTheirBounds) {
  LogConfig config;
  std::map<std::string, std::pair<double, double>> bounds;
  for (const Option& option : option_table(config)) bounds[std::string(option.path)] = {option.min, option.max};
  const auto both = [](double most) { return std::pair(-most, most); };
  for (const char* name : {"log.mount_x", "log.mount_y"}) EXPECT_EQ(bounds.at(name), both(100.0)) << name;
  for (const char* name : {"log.mount_angle", "log.first_bearing", "log.bearing_step", "log.crank_step"}) {
    EXPECT_EQ(bounds.at(name), both(6.3)) << name << ": a whole turn, and a little";
  }
  for (const char* name : {"log.first_beam_after", "log.beam_period", "log.odometry_delay"}) {
    EXPECT_EQ(bounds.at(name), both(10.0)) << name;
  }
  EXPECT_EQ(bounds.at("log.max_range"), std::pair(0.0, 1000.0));
  EXPECT_EQ(bounds.at("log.clock_offset"), both(1e10)) << "of a clock that began in 1970, and one that begins at 0";
  EXPECT_EQ(bounds.at("log.crank_zero"), both(1e9));
}

TEST(LogSettings, AllTablesAreOne) {
  Settings settings;
  std::map<std::string, int> parts;
  for (const Option& option : option_table(settings))
    ++parts[std::string(option.path.substr(0, option.path.find('.')))];
  for (const char* part : {"search", "occupancy", "nod", "cloud", "log"}) EXPECT_GT(parts[part], 0) << part;
  LogConfig log;
  EXPECT_EQ(static_cast<std::size_t>(parts["log"]), option_table(log).size());
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

TEST(LogSettings, ACrankHasItsLimits) {
  const auto is_valid = [](double max_gap_s, double max_turns_per_s) {
    Settings settings;
    settings.nod_limits = {.max_gap_s = max_gap_s, .max_turns_per_s = max_turns_per_s};
    try {
      require_valid(settings);
      return true;
    } catch (const ConfigError&) {
      return false;
    }
  };
  EXPECT_TRUE(is_valid(0.001, 0.01) && is_valid(3600.0, 1000.0));
  EXPECT_FALSE(is_valid(0.0009, 1.0) || is_valid(3601.0, 1.0));
  EXPECT_FALSE(is_valid(1.0, 0.009) || is_valid(1.0, 1001.0));
}

}  // namespace
}  // namespace gdtslam
