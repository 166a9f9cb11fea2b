// Which surface a range is of, against the geometry of an upright room: a beam at elevation e from an axis that is d
// away meets the wall after d / cos(e), a floor that is h below after h / -sin(e), a ceiling likewise; it is of the
// nearest.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "gdtslam/calib/calibration.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

constexpr double kRoomWall_m = 2.0;
constexpr double kRoomFloor_m = 0.4;
constexpr double kRoomCeiling_m = 2.1;

std::vector<CalibrationSurface> upright_room() {
  return {{.name = "wall", .distance_m = kRoomWall_m},
          {.name = "floor", .kind = SurfaceKind::kFloor, .distance_m = kRoomFloor_m},
          {.name = "ceiling", .kind = SurfaceKind::kCeiling, .distance_m = kRoomCeiling_m}};
}

struct Meeting {
  std::uint32_t surface = 0;
  double range_m = 0.0;
  double incidence = 0.0;  // cosine of the beam to the normal
};

// Where a level beam that is turned up by the elevation ends, with the surfaces that are there.
Meeting met(double elevation, bool has_floor = true) {
  Meeting nearest{9, 1e9, 0.0};
  const auto offer = [&](std::uint32_t surface, double distance, double incidence) {
    if (incidence > 0.0 && distance / incidence < nearest.range_m) nearest = {surface, distance / incidence, incidence};
  };
  offer(0, kRoomWall_m, std::cos(elevation));
  if (has_floor) offer(1, kRoomFloor_m, -std::sin(elevation));
  offer(2, kRoomCeiling_m, std::sin(elevation));
  return nearest;
}

// A mount whose elevations reach the floor, the wall and the ceiling, and the forward beams of a turn.
SweepModel wide_mount() {
  SweepModel model = sweep_model_of_preset("paper-b");
  model.mount = {};
  model.elevation_offset_rad -= 0.6;
  return model;
}

struct TurnedBeam {
  double ticks;
  double elevation;
};

std::vector<TurnedBeam> beams_of_a_turn(const SweepModel& model) {
  std::vector<TurnedBeam> all;
  for (int stop = 0; stop < 400; ++stop) {
    const double ticks = static_cast<double>(model.encoder.ticks_per_turn) * stop / 400.0;
    all.push_back({ticks, *elevation_rad(model, crank_rad(model.encoder, ticks))});
  }
  return all;
}

TEST(AssignSurfaces, EachRangeIsOfTheSurfaceThatItsBeamMeetsFirst) {
  const SweepModel model = wide_mount();
  std::vector<RangeObservation> seen;
  std::vector<std::uint32_t> expected;
  std::array<int, 3> counts{};
  for (const TurnedBeam& beam : beams_of_a_turn(model)) {
    const Meeting meeting = met(beam.elevation);
    ASSERT_LT(meeting.surface, 3U);
    seen.push_back({.ticks = beam.ticks, .range_m = meeting.range_m, .surface = 2});
    expected.push_back(meeting.surface);
    ++counts.at(meeting.surface);
  }
  for (const int count : counts) ASSERT_GT(count, 10);
  EXPECT_EQ(assign_surfaces(model, upright_room(), 0.001, seen), 0U);
  ASSERT_EQ(seen.size(), expected.size());
  for (std::size_t k = 0; k < seen.size(); ++k) EXPECT_EQ(seen[k].surface, expected[k]) << k;
}

// By hand: of ten level ranges to a wall 2 m away three are right, three are 0.2 m off either way, two farther off than
// half a metre, and two look away from it.
TEST(MeanMiss, CountsWhatMissesByMoreAsTheMost) {
  const SweepModel model = wide_mount();
  double level_ticks = 0.0;
  for (const TurnedBeam& beam : beams_of_a_turn(model)) {
    if (std::fabs(beam.elevation) < 0.01) level_ticks = beam.ticks;
  }
  const double cosine = std::cos(*elevation_rad(model, crank_rad(model.encoder, level_ticks)));
  std::vector<RangeObservation> seen;
  for (const double off_m : {0.0, 0.0, 0.0, 0.2, -0.2, 0.2, 0.7, -1.5}) {
    seen.push_back({.ticks = level_ticks, .range_m = (kRoomWall_m + off_m) / cosine});
  }
  for (int k = 0; k < 2; ++k) seen.push_back({.ticks = level_ticks, .bearing_rad = kPi, .range_m = kRoomWall_m});
  const std::vector<CalibrationSurface> wall{upright_room()[0]};
  EXPECT_NEAR(mean_miss_m(model, wall, 0.5, seen), (3 * 0.2 + 4 * 0.5) / 10.0, 1e-3);
  EXPECT_EQ(mean_miss_m(model, wall, 0.5, {}), 0.0);
}

// The gate is on the distance from the surface, not along the beam.
TEST(AssignSurfaces, WhatMissesByMoreThanTheGateIsTakenOut) {
  constexpr double kGate_m = 0.1;
  const SweepModel model = wide_mount();
  for (const double miss_m : {-0.101, -0.099, 0.099, 0.101}) {
    std::vector<RangeObservation> seen;
    for (const TurnedBeam& beam : beams_of_a_turn(model)) {
      const Meeting meeting = met(beam.elevation);
      seen.push_back({.ticks = beam.ticks, .range_m = meeting.range_m + miss_m / meeting.incidence});
    }
    const std::size_t all = seen.size();
    const bool is_within = std::fabs(miss_m) < kGate_m;
    EXPECT_EQ(assign_surfaces(model, upright_room(), kGate_m, seen), is_within ? 0U : all) << miss_m;
    EXPECT_EQ(seen.size(), is_within ? all : 0U) << miss_m;
  }
}

TEST(AssignSurfaces, WhatMeetsNoSurfaceIsTakenOut) {
  const SweepModel model = wide_mount();
  const std::vector<CalibrationSurface> ceiling{upright_room()[2]};
  std::vector<RangeObservation> seen;
  std::size_t upward = 0;
  for (const TurnedBeam& beam : beams_of_a_turn(model)) {
    if (std::fabs(beam.elevation) < 0.1) continue;  // too flat for a ceiling to say anything
    upward += beam.elevation > 0.0 ? 1U : 0U;
    seen.push_back({.ticks = beam.ticks, .range_m = kRoomCeiling_m / std::fabs(std::sin(beam.elevation))});
  }
  const std::size_t all = seen.size();
  ASSERT_GT(upward, 10U);
  ASSERT_LT(upward, all);
  EXPECT_EQ(assign_surfaces(model, ceiling, 0.01, seen), all - upward);
  EXPECT_EQ(seen.size(), upward);
}

// docs/linkage.md, presets: reading A is bars L2, L4, L5, L3, B is L2, L4, L5, L6 and C is L2, L4, L6, L5.
TEST(PaperBars, StandWhereTheReadingsHaveThem) {
  const auto places = [](const std::string& model) {
    std::string text;
    for (const PaperBar& bar : paper_bars(model)) text += bar.name + "=" + bar.place + " ";
    return text;
  };
  EXPECT_EQ(places("paper-a"), "delta1= delta2=crank delta3=ground delta4=coupler delta5=rocker delta6= delta7= ");
  EXPECT_EQ(places("paper-b"), "delta1= delta2=crank delta3= delta4=coupler delta5=rocker delta6=ground delta7= ");
  EXPECT_EQ(places("paper-c"), "delta1= delta2=crank delta3= delta4=coupler delta5=ground delta6=rocker delta7= ");
  EXPECT_EQ(places("paper-b-calibrated"), places("paper-b"));
  for (const char* other : {"paper-d", "paper-", "paper", "paper-clip", "paper-a-mended", "mine", ""})
    EXPECT_TRUE(paper_bars(other).empty()) << other;
  for (const char* bar : {"crank", "coupler", "rocker", "ground"}) EXPECT_TRUE(is_bar(bar)) << bar;
  for (const char* other : {"zero", "offset", "distance.wall", "lever.up", "crank.x", ""}) {
    EXPECT_FALSE(is_bar(other)) << other;
  }
}

}  // namespace
}  // namespace gdtslam::calib
