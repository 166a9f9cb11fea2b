// Moments of closing loops as shapes, without pixels.
#include "engine/drawing/maps/map_pictures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

class LoopsMoments : public testing::Test {
 protected:
  LoopsMoments() {
    scene_.map = &map_;
    scene_.extent = round_trip().trajectory;
    scene_.has_loops_on = scene_.has_loops_off = true;
    scene_.largest_sigma_m = 0.2;
    for (const StampedPose& pose : scene_.extent) moment_.path_m.push_back(pose.T_map_base.translation());
    moment_.walls_m = {{0.0, 0.0}, {1.0, 1.0}};
    moment_.loops = {{.from_m = {0.0, 0.0}, .to_m = {2.0, 1.0}, .weight = 1.0, .is_on = true, .glow = 0.0},
                     {.from_m = {0.5, 0.0}, .to_m = {2.0, 0.5}, .weight = 0.1, .is_on = false, .glow = 0.0}};
    moment_.robot_m = Point2(2.0, 1.0);
    moment_.robot_covariance = {.xx = 0.04, .yy = 0.01};
  }
  [[nodiscard]] Canvas drawn() const {
    MapLook look;
    look.title = "t";
    look.subtitle = "s";
    return loops_picture(scene_, moment_, look, {1600, 1200});
  }

  OccupancyMap map_ = two_rooms();
  LoopsScene scene_;
  LoopsMoment moment_;
};

TEST_F(LoopsMoments, LegendIsTheSameWhateverTheMoment) {
  const auto legend = [this] {
    std::vector<std::pair<std::string, double>> words;
    for (const shape::Words& one : shapes_of<shape::Words>(drawn())) words.emplace_back(one.text, one.at.y());
    return words;
  };
  const auto all = legend();
  moment_.loops.clear();
  moment_.robot_m.reset();
  moment_.map_share = 1.0;
  EXPECT_EQ(legend(), all);
  EXPECT_TRUE(says(drawn(), "loop switched off"));
  EXPECT_TRUE(says(drawn(), "3 sigma"));
  scene_.has_loops_off = false;
  scene_.largest_sigma_m = 0.0;
  EXPECT_FALSE(says(drawn(), "switched off"));
  EXPECT_FALSE(says(drawn(), "sigma"));
}

TEST_F(LoopsMoments, WhatIsNotFiniteIsLeftOut) {
  const double bad = std::nan("");
  moment_.path_m.emplace_back(bad, 0.0);
  moment_.walls_m.emplace_back(0.0, 1e300);
  moment_.loops.push_back({.from_m = {bad, bad}, .to_m = {0.0, 0.0}, .weight = 1.0, .is_on = true, .glow = 1.0});
  moment_.robot_covariance.xx = bad;
  for (const shape::Line& line : shapes_of<shape::Line>(drawn())) {
    for (const Point2& point : line.points) EXPECT_TRUE(std::isfinite(point.x()) && std::isfinite(point.y()));
  }
}

}  // namespace
}  // namespace gdtslam
