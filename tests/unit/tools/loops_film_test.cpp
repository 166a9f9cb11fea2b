// The film of closing loops: which frame shows what, and how the path bends between the places of its graph.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "tools/gdtslam/render/loops_film.hpp"

namespace gdtslam {
namespace {

TEST(LoopsTimeline, GoesForwardThroughEveryStageAndEndsStill) {
  for (const std::size_t stages : {0U, 1U, 3U, 17U}) {
    std::vector<double> stages_m;
    for (std::size_t k = 1; k <= stages; ++k)
      stages_m.push_back(100.0 * static_cast<double>(k) / static_cast<double>(stages));
    const LoopsFilmLength length{300, 25};
    ASSERT_LE(stages, most_loop_stages(length));
    const std::vector<LoopsInstant> frames = loops_timeline(stages_m, 100.0, length);
    ASSERT_EQ(frames.size(), 300U);
    std::vector<std::size_t> shown(stages + 2, 0);
    for (std::size_t k = 0; k < frames.size(); ++k) {
      ++shown[frames[k].stage];
      if (k == 0) continue;
      EXPECT_GE(frames[k].driven_m, frames[k - 1].driven_m);
      EXPECT_GE(frames[k].stage, frames[k - 1].stage);
      EXPECT_LE(frames[k].stage, frames[k - 1].stage + 1);
      EXPECT_GE(frames[k].map_share, frames[k - 1].map_share);
      const bool bends_on = frames[k].bent >= frames[k - 1].bent;
      EXPECT_TRUE(bends_on || frames[k].stage > frames[k - 1].stage);
    }
    for (const std::size_t count : shown) EXPECT_GE(count, 4U) << "too short to be seen";
    EXPECT_EQ(frames[0].stage, 0U);
    for (std::size_t k = 275; k < 300; ++k) {
      EXPECT_EQ(frames[k].driven_m, 100.0);
      EXPECT_EQ(frames[k].stage, stages + 1);
      EXPECT_EQ(frames[k].bent, 1.0);
      EXPECT_EQ(frames[k].map_share, 1.0);
      EXPECT_TRUE(frames[k].is_over);
    }
  }
}

/// East for 8 m, then north for 8 m, a pose every quarter of a metre; places every 4 m.
Trajectory bent_drive() {
  Trajectory trajectory;
  for (int k = 0; k <= 64; ++k) {
    const double along_m = 0.25 * k;
    const Pose2 pose = k <= 32 ? Pose2{along_m, 0.0, 0.0} : Pose2{8.0, along_m - 8.0, 0.5 * kPi};
    trajectory.push_back({0.1 * k, pose});
  }
  return trajectory;
}

OccupancyMap wall_in_the_east() {
  OccupancyMap map;
  map.geometry = {0.1, -2.0, -2.0, 140, 140};
  map.cells = CellStates(std::vector(map.geometry.cell_count(), CellState::kFree));
  for (std::int32_t y = 0; y < 140; ++y) map.cells.set(static_cast<std::size_t>(y) * 140U + 120U, CellState::kOccupied);
  return map;
}

TEST(LoopsPath, IsTheTrajectoryWhereThePlacesStay) {
  const Trajectory trajectory = bent_drive();
  const LoopsPath path(trajectory, {0, 16, 32, 48, 60}, wall_in_the_east());
  EXPECT_NEAR(path.length_m(), 16.0, 1e-12);
  EXPECT_EQ(path.place_at(11.9), 2U);
  EXPECT_EQ(path.place_at(12.1), 3U);
  EXPECT_NEAR(path.stamp_at(8.0), 3.2, 1e-12);
  const std::vector<Point2> bent = path.bent(path.final_places(), 16.0);
  ASSERT_EQ(bent.size(), trajectory.size());
  for (std::size_t i = 0; i < bent.size(); ++i) {
    EXPECT_NEAR((bent[i] - trajectory[i].T_map_base.translation()).norm(), 0.0, 1e-12) << i;
  }
  EXPECT_EQ(path.bent(path.final_places(), 4.0).size(), 17U) << "up to 4 m, both ends counted";
}

// All places turned about the first turn the whole path, and what was seen, about it.
TEST(LoopsPath, TurnsAsAWholeWithItsPlaces) {
  const Trajectory trajectory = bent_drive();
  const LoopsPath path(trajectory, {0, 16, 32, 48, 64}, wall_in_the_east());
  const Pose2 T_turned_map{1.0, -2.0, 0.3};
  std::vector<Pose2> places;
  for (const Pose2& place : path.final_places()) places.push_back(T_turned_map * place);
  const std::vector<Point2> bent = path.bent(places, 16.0);
  for (std::size_t i = 0; i < bent.size(); ++i) {
    EXPECT_NEAR((bent[i] - T_turned_map * trajectory[i].T_map_base.translation()).norm(), 0.0, 1e-9) << i;
  }
  const std::vector<Point2> walls = path.walls(places, 16.0);
  EXPECT_GT(walls.size(), 100U);
  for (const Point2& wall : walls) EXPECT_NEAR((inverse(T_turned_map) * wall).x(), 10.05, 1e-9) << "not on the wall";
  EXPECT_LT(path.walls(places, 1.0).size(), walls.size()) << "the first place has not seen what all have";
}

}  // namespace
}  // namespace gdtslam
