// What options allow together, and how boxes of cells grow: at and beside each limit, by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/mapping/map/store/growth.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> violations_with(const std::function<void(MapperConfig&)>& change) {
  MapperConfig config;
  change(config);
  return validate(config);
}

TEST(ConfigRules, TheTruncationIs255CellsAtMost) {
  const auto with = [](double resolution_m, double truncation_m) {
    return violations_with([&](MapperConfig& config) {
      config.map.resolution_m = resolution_m;
      config.map.truncation_m = truncation_m;
    });
  };
  EXPECT_THAT(with(0.05, 12.77), IsEmpty());
  EXPECT_THAT(with(0.05, 12.78), ElementsAre(HasSubstr("map.truncation is 256 cells")));
  EXPECT_THAT(with(1.0, 0.49), ElementsAre(HasSubstr("map.truncation is 0 cells")));
  EXPECT_THAT(with(1.0, 0.51), IsEmpty());
}

TEST(ConfigRules, TheTruncationIsLargerThanTwoFinalGates) {
  const auto with = [](double truncation_m) {
    return violations_with([&](MapperConfig& config) {
      config.map.truncation_m = truncation_m;
      config.gate.final_m = 0.25;
    });
  };
  EXPECT_THAT(with(0.5), ElementsAre(HasSubstr("larger than twice gate.final")));
  EXPECT_THAT(with(0.51), IsEmpty());
}

TEST(ConfigRules, TheFinalGateIsNoWiderThanTheFirst) {
  const auto with = [](double final_m) {
    return violations_with([&](MapperConfig& config) {
      config.gate.wide_m = 0.125;
      config.gate.final_m = final_m;
    });
  };
  EXPECT_THAT(with(0.125), IsEmpty());
  EXPECT_THAT(with(0.126), ElementsAre(HasSubstr("gate.final must not be larger")));
}

// 2^25 samples: 3343 squared times three angles are fewer, 3345 squared more; so with nine angles 1929 and 1931.
TEST(ConfigRules, AWindowHasThirtyThreeMillionSamplesAtMost) {
  const auto with = [](double halves, double step_rad) {
    return violations_with([&](MapperConfig& config) {
      config.search.step_m = 0.5;
      config.search.max_half_m = 0.5 * halves;
      config.search.step_rad = step_rad;
    });
  };
  EXPECT_THAT(with(1671.0, 3.15), IsEmpty());
  EXPECT_THAT(with(1671.5, 3.15), ElementsAre(HasSubstr("more than 33554432 poses")));
  EXPECT_THAT(with(964.0, 1.0), IsEmpty());
  EXPECT_THAT(with(965.0, 1.0), ElementsAre(HasSubstr("more than 33554432 poses")));
  EXPECT_THAT(violations_with([](MapperConfig& config) {
                config.search.step_m = 0.005;
                config.search.max_half_m = 1000.0;
              }),
              ElementsAre(HasSubstr("more than 33554432 poses")));
}

TEST(ConfigRules, WhatProvesWindowsNeedsTheCostThatItBounds) {
  const auto with = [](MatcherKind matcher, CostForm cost, Interpolation interpolation) {
    return violations_with([&](MapperConfig& config) {
      config.match.matcher = matcher;
      config.match.cost = cost;
      config.match.interpolation = interpolation;
    });
  };
  EXPECT_THAT(with(MatcherKind::kCertified, CostForm::kDistance, Interpolation::kBilinear), IsEmpty());
  EXPECT_THAT(with(MatcherKind::kCertified, CostForm::kSquared, Interpolation::kBilinear),
              ElementsAre(HasSubstr("match.matcher certified needs")));
  EXPECT_THAT(with(MatcherKind::kCertified, CostForm::kDistance, Interpolation::kNearest),
              ElementsAre(HasSubstr("match.matcher certified needs")));
  EXPECT_THAT(with(MatcherKind::kSimplex, CostForm::kSquared, Interpolation::kNearest), IsEmpty());
}

TEST(BoxesOfCells, HaveAHullAndACommonPart) {
  const CellBox a{{0, 10}, {5, 20}};
  const CellBox b{{3, -5}, {9, 12}};
  EXPECT_EQ(bounding_box(a, b), (CellBox{{0, -5}, {9, 20}}));
  EXPECT_EQ(bounding_box(b, a), (CellBox{{0, -5}, {9, 20}}));
  EXPECT_EQ(bounding_box(a, CellBox{}), a);
  EXPECT_EQ(bounding_box(CellBox{}, a), a);
  EXPECT_EQ(common_part(a, b), (CellBox{{3, 10}, {5, 12}}));
  EXPECT_EQ(common_part(b, a), (CellBox{{3, 10}, {5, 12}}));
  EXPECT_TRUE(common_part(a, CellBox{{5, 10}, {9, 20}}).empty());
}

bool fits_anything(const CellBox&) { return true; }

CellBox stored_for(const GridBoxes& now, const CellBox& box,
                   const std::function<bool(const CellBox&)>& fits = fits_anything) {
  const std::optional<GridBoxes> grown = grown_to_hold(now, box, fits);
  return grown ? grown->stored : CellBox{};
}

// A quarter of the extent, 64 cells at least.
TEST(GrowingBoxes, GetAMarginAtEachSideThatMoves) {
  EXPECT_EQ(stored_for({}, {{0, 0}, {400, 80}}), (CellBox{{-100, -64}, {500, 144}}));
  EXPECT_EQ(stored_for({}, {{0, 0}, {256, 260}}), (CellBox{{-64, -65}, {320, 325}}));
  const CellBox whole{{0, 0}, {400, 400}};
  const GridBoxes now{whole, whole};
  EXPECT_EQ(stored_for(now, {{390, 5}, {420, 9}}), (CellBox{{0, 0}, {525, 400}}));
  EXPECT_EQ(stored_for(now, {{-20, 5}, {20, 9}}), (CellBox{{-125, 0}, {400, 400}}));
  EXPECT_EQ(stored_for(now, {{5, 390}, {9, 420}}), (CellBox{{0, 0}, {400, 525}}));
  EXPECT_EQ(stored_for(now, {{5, -20}, {9, 20}}), (CellBox{{0, -125}, {400, 400}}));
  EXPECT_EQ(stored_for(now, whole), whole);
  const std::optional<GridBoxes> within =
      grown_to_hold({{{0, 0}, {10, 10}}, whole}, {{20, 20}, {30, 30}}, fits_anything);
  ASSERT_TRUE(within);
  EXPECT_EQ(within->content, (CellBox{{0, 0}, {30, 30}}));
  EXPECT_EQ(within->stored, whole);
}

TEST(GrowingBoxes, TakeTheLargestMarginThatFits) {
  const CellBox whole{{0, 0}, {400, 400}};
  const auto no_wider_than = [](std::int32_t most) {
    return [most](const CellBox& box) { return box.width() <= most; };
  };
  EXPECT_EQ(stored_for({whole, whole}, {{390, 5}, {420, 9}}, no_wider_than(450)), (CellBox{{0, 0}, {450, 400}}));
  EXPECT_EQ(stored_for({whole, whole}, {{390, 5}, {420, 9}}, no_wider_than(420)), (CellBox{{0, 0}, {420, 400}}));
  // Where what is stored does not fit any more its margins are given up, and the content has some at all sides: 45 of
  // 80 across, as large a share of 64 up and down.
  const GridBoxes now{{{100, 100}, {300, 300}}, whole};
  EXPECT_EQ(stored_for(now, {{290, 105}, {420, 109}}, no_wider_than(410)), (CellBox{{55, 64}, {465, 336}}));
  EXPECT_FALSE(grown_to_hold(now, {{290, 105}, {420, 109}}, no_wider_than(319)));
  EXPECT_TRUE(grown_to_hold(now, {{290, 105}, {420, 109}}, no_wider_than(320)));
}

}  // namespace
}  // namespace gdtslam
