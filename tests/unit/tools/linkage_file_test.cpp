// Linkage files: what is read, that what is written reads back, and one clear line for what cannot be read.
#include "engine/runs/folder/linkage_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kBars = "bars: {crank: 3.6 cm, coupler: 85 mm, rocker: 8.8 cm, ground: 0.05}\n";

calib::SweepModel model_of(const std::string& lines) {
  return read_linkage_text("gdtslam_linkage: 1\n" + lines, "l.yaml").model;
}

// The message for a linkage whose lines after the first are given, from the line's number on.
std::string refusal(const std::string& lines) {
  try {
    static_cast<void>(model_of(lines));
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_THAT(message, StartsWith("l.yaml:"));
    EXPECT_EQ(error.code(), ExitCode::kBadConfig);
    return message.substr(7);
  }
  return "accepted";
}

TEST(LinkageFile, ReadsEveryKey) {
  const LinkageFile file = read_linkage_text(R"(
gdtslam_linkage: 1
name: mine
description: everything once
bars: {crank: 3.6 cm, coupler: 85 mm, rocker: 8.8 cm, ground: 0.05}
assembly: crossed
encoder: {ticks_per_turn: 4096, zero: 12 deg, direction: -1, wraps: false}
elevation: {sign: -1, offset: -0.25 rad}
mount: {height: 1.2 m, lever_forward: 3 cm, lever_up: -5 mm, roll: 1 deg, yaw: -2 deg}
laser: {mirror_rate: 25 Hz, stamp: 100 %}
uncertainty: {crank: 0.1 mm, zero: 1 mrad, lever.up: 2 mm, sensor.yaw: 0.1 deg}
)",
                                             "l.yaml");
  const calib::SweepModel& model = file.model;
  EXPECT_EQ(model.name, "mine");
  EXPECT_EQ(model.bars.crank_m, 0.036);
  EXPECT_EQ(model.bars.coupler_m, 0.085);
  EXPECT_EQ(model.bars.rocker_m, 0.088);
  EXPECT_EQ(model.bars.ground_m, 0.05);
  EXPECT_EQ(model.assembly, calib::Assembly::kCrossed);
  EXPECT_EQ(model.encoder.ticks_per_turn, 4096);
  EXPECT_DOUBLE_EQ(model.encoder.zero_rad, rad_from_deg(12.0));
  EXPECT_EQ(model.encoder.direction, -1);
  EXPECT_FALSE(model.encoder.wraps);
  EXPECT_EQ(model.elevation_sign, -1);
  EXPECT_EQ(model.elevation_offset_rad, -0.25);
  EXPECT_EQ(model.mount.height_m, 1.2);
  EXPECT_EQ(model.mount.lever_forward_m, 0.03);
  EXPECT_EQ(model.mount.lever_up_m, -0.005);
  EXPECT_DOUBLE_EQ(model.mount.sensor_roll_rad, rad_from_deg(1.0));
  EXPECT_DOUBLE_EQ(model.mount.sensor_yaw_rad, rad_from_deg(-2.0));
  EXPECT_EQ(model.mirror_rate_hz, 25.0);
  EXPECT_EQ(model.stamp_share, 1.0);
  EXPECT_THAT(file.uncertainty,
              ElementsAre(ParameterSigma{"crank", 1e-4}, ParameterSigma{"zero", 1e-3}, ParameterSigma{"lever.up", 2e-3},
                          ParameterSigma{"sensor.yaw", rad_from_deg(0.1)}));
}

TEST(LinkageFile, BarsAloneAreSetUpAsThePresetsAre) {
  const calib::SweepModel model = model_of(kBars);
  const calib::SweepModel preset = calib::sweep_model_of_preset("paper-b");
  EXPECT_EQ(model.name, "l");
  EXPECT_EQ(model.encoder.zero_rad, preset.encoder.zero_rad);
  EXPECT_EQ(model.encoder.direction, preset.encoder.direction);
  EXPECT_EQ(model.elevation_offset_rad, preset.elevation_offset_rad);
  EXPECT_EQ(model.mirror_rate_hz, 0.0);
}

TEST(LinkageFile, APresetWithOverrides) {
  const calib::SweepModel model = model_of("preset: paper-c\nbars: {crank: 3.5 cm}\nmount: {height: 1 m}\n");
  const calib::FourBar& bars = calib::linkage_preset("paper-c").bars;
  EXPECT_EQ(model.name, "paper-c");
  EXPECT_EQ(model.bars.crank_m, 0.035);
  EXPECT_EQ(model.bars.coupler_m, bars.coupler_m);
  EXPECT_EQ(model.mirror_rate_hz, 40.0);
  EXPECT_EQ(model.mount.height_m, 1.0);
  // The dead points are those of the bars as they are, not of the preset's.
  EXPECT_NEAR(calib::elevation_rad(model, model.encoder.zero_rad).value(), 0.0, 1e-9);
  EXPECT_NE(model.encoder.zero_rad, calib::sweep_model_of_preset("paper-c").encoder.zero_rad);
}

TEST(LinkageFile, AUnitMistakeIsNamed) {
  EXPECT_EQ(refusal("bars:\n  coupler: 8.5 cm\n  crank: 3.6\n  rocker: 8.8 cm\n  ground: 5 cm\n"),
            "4: bars.crank = 3.6 m is longer than 1 m; did you mean 3.6 cm?");
  EXPECT_THAT(refusal("bars: {crank: 3.6 deg, coupler: 8.5 cm, rocker: 8.8 cm, ground: 5 cm}\n"),
              HasSubstr("unit 'deg' does not fit here"));
  EXPECT_THAT(refusal(std::string(kBars) + "encoder: {zero: 90}\n"), HasSubstr("an angle needs its unit"));
}

TEST(LinkageFile, ACrankThatCannotTurnIsRefusedUnlessAllIsStated) {
  const std::string bars = "bars: {crank: 6 cm, coupler: 8.5 cm, rocker: 8.8 cm, ground: 12 cm}\n";
  EXPECT_THAT(refusal(bars), AllOf(StartsWith("2: bars: the crank cannot turn fully"), HasSubstr("18 > ")));
  EXPECT_THAT(refusal(bars + "encoder: {zero: 0 deg}\n"), HasSubstr("or give elevation.offset too"));
  EXPECT_EQ(refusal(bars + "encoder: {zero: 0 deg}\nelevation: {offset: 10 deg}\n"), "accepted");
}

TEST(LinkageFile, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(refusal("preset: paper-b\nencodr: {}\n"), "3: unknown key 'encodr'; did you mean 'encoder'?");
  EXPECT_THAT(refusal("preset: paper-b\nencoder: {ticks: 5}\n"), HasSubstr("unknown key 'ticks'"));
  EXPECT_THAT(refusal("preset: paper-x\n"), AllOf(StartsWith("2: preset: "), HasSubstr("paper-b")));
  EXPECT_THAT(refusal("preset: paper-b\nassembly: opn\n"), HasSubstr("did you mean 'open'?"));
  EXPECT_THAT(refusal("preset: paper-b\nuncertainty: {crnk: 1 mm}\n"), HasSubstr("did you mean 'crank'?"));
  EXPECT_THAT(refusal("preset: paper-b\nuncertainty: {crank: -1 mm}\n"), HasSubstr("not negative"));
  EXPECT_THAT(refusal("preset: paper-b\nencoder: {ticks_per_turn: 2.5}\n"), HasSubstr("not a whole number"));
  EXPECT_THAT(refusal("preset: paper-b\nelevation: {sign: -1}\n"), HasSubstr("elevation.offset is missing"));
  EXPECT_THAT(refusal("preset: paper-b\nlaser:\n  stamp: 2\n"), StartsWith("4: laser.stamp = 2 must be 0 to 1"));
  EXPECT_THAT(refusal("preset: paper-b\npreset: paper-a\n"), HasSubstr("stands twice"));
  EXPECT_THAT(refusal("preset: paper-b\n\"a\\nb\": 1\n"), HasSubstr("unknown key 'a?b'"));
}

TEST(LinkageFile, WhatIsWrittenReadsBackWithTheSameBits) {
  calib::SweepModel model = calib::sweep_model_of_preset("paper-a-calibrated");
  model.name = "a \"name\" with \\ and\ttab: #1";
  model.assembly = calib::Assembly::kCrossed;
  model.bars.crank_m = 0.034822123456789012;
  model.encoder = {.ticks_per_turn = 1 << 30, .zero_rad = -1.0 / 3.0, .direction = -1, .wraps = false};
  model.elevation_sign = -1;
  model.elevation_offset_rad = 2.0 / 7.0;
  model.mount = {.height_m = 0.3000000000000001,
                 .lever_forward_m = -0.01,
                 .lever_up_m = 1e-17,
                 .sensor_roll_rad = 0.1,
                 .sensor_yaw_rad = rad_from_deg(3.0)};
  model.mirror_rate_hz = 39.97;
  model.stamp_share = 1.0 / 3.0;
  const std::vector<ParameterSigma> uncertainty{{"crank", 1e-5 / 3.0}, {"offset", 1e-3 / 3.0}};
  const LinkageFile back = read_linkage_text(linkage_text(model, uncertainty), "w.yaml");
  EXPECT_EQ(back.model.name, model.name);
  EXPECT_EQ(back.model.assembly, model.assembly);
  EXPECT_EQ(back.model.bars.crank_m, model.bars.crank_m);
  EXPECT_EQ(back.model.bars.coupler_m, model.bars.coupler_m);
  EXPECT_EQ(back.model.bars.rocker_m, model.bars.rocker_m);
  EXPECT_EQ(back.model.bars.ground_m, model.bars.ground_m);
  EXPECT_EQ(back.model.encoder.ticks_per_turn, model.encoder.ticks_per_turn);
  EXPECT_EQ(back.model.encoder.zero_rad, model.encoder.zero_rad);
  EXPECT_EQ(back.model.encoder.direction, model.encoder.direction);
  EXPECT_EQ(back.model.encoder.wraps, model.encoder.wraps);
  EXPECT_EQ(back.model.elevation_sign, model.elevation_sign);
  EXPECT_EQ(back.model.elevation_offset_rad, model.elevation_offset_rad);
  EXPECT_EQ(back.model.mount.height_m, model.mount.height_m);
  EXPECT_EQ(back.model.mount.lever_forward_m, model.mount.lever_forward_m);
  EXPECT_EQ(back.model.mount.lever_up_m, model.mount.lever_up_m);
  EXPECT_EQ(back.model.mount.sensor_roll_rad, model.mount.sensor_roll_rad);
  EXPECT_EQ(back.model.mount.sensor_yaw_rad, model.mount.sensor_yaw_rad);
  EXPECT_EQ(back.model.mirror_rate_hz, model.mirror_rate_hz);
  EXPECT_EQ(back.model.stamp_share, model.stamp_share);
  EXPECT_EQ(back.uncertainty, uncertainty);
}

// The shipped files are the presets, bit for bit.
TEST(LinkageFile, AssetsAreThePresets) {
  const std::filesystem::path folder = std::filesystem::path(GDTSLAM_SOURCE_DIR) / "assets" / "linkages";
  for (const calib::LinkagePreset& preset : calib::linkage_presets()) {
    const std::string file = (folder / (std::string(preset.name) + ".yaml")).string();
    EXPECT_EQ(linkage_text(read_linkage(file)), linkage_text(calib::sweep_model_of_preset(preset.name))) << file;
  }
}

}  // namespace
}  // namespace gdtslam
