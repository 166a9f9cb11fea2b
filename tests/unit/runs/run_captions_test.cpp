// What stands below the picture of a run's graph, by hand.
#include <gtest/gtest.h>

#include <vector>

#include "engine/runs/folder/run_pictures.hpp"

namespace gdtslam {
namespace {

std::vector<ClosedLoop> loops_of(std::size_t on, std::size_t off) {
  std::vector<ClosedLoop> loops(on + off);
  for (std::size_t i = 0; i < on; ++i) loops[i].is_on = true;
  return loops;
}

TEST(RunCaptions, LoopsAreCountedByWhetherTheyHold) {
  EXPECT_EQ(graph_subtitle(loops_of(20, 3), {}, 1803), "1,803 scans, 20 of 23 loops on");
  EXPECT_EQ(graph_subtitle(loops_of(23, 0), {}, 1), "1 scan, 23 loops, all on");
  EXPECT_EQ(graph_subtitle(loops_of(1, 0), {}, 2), "2 scans, 1 loop on");
  EXPECT_EQ(graph_subtitle(loops_of(0, 2), {}, 2), "2 scans, 2 loops switched off");
  EXPECT_EQ(graph_subtitle(loops_of(0, 0), {}, 2), "2 scans, no loop found");
}

// Three poses a metre apart, and two 50 m to the side: of one drive, or of two.
TEST(RunCaptions, NothingWasDrivenFromOneDriveToTheNext) {
  Trajectory path;
  for (int k = 0; k < 5; ++k) path.push_back({1.0 * k, {1.0 * k, k < 3 ? 0.0 : 50.0, 0.0}});
  path[3].T_map_base.x_m = 2.0;
  path[4].T_map_base.x_m = 3.0;
  EXPECT_EQ(run_subtitle({5, 0, 0}, path, {}), "5 scans, 53.0 m of path");
  const std::vector<std::size_t> drives{3};
  EXPECT_EQ(run_subtitle({5, 0, 0}, path, drives), "5 scans, 3.0 m of path");
  EXPECT_EQ(path_length_text(path, drives), "3.0 m");
}

// Both ends of a stretch belong to it; the worst of them is told.
TEST(RunCaptions, ScansThatAreNotToBeTrustedAreCounted) {
  std::vector<UncertainStretch> uncertain(2);
  uncertain[0].from = 3;
  uncertain[0].to = 40;
  uncertain[0].sigma_m = 0.3;
  uncertain[1].from = 100;
  uncertain[1].to = 101;
  uncertain[1].sigma_m = 0.2;
  EXPECT_EQ(graph_subtitle(loops_of(20, 3), uncertain, 1803),
            "1,803 scans, 20 of 23 loops on; 40 scans not to be trusted, standard deviation up to 0.3 m");
  uncertain = {uncertain[1]};
  uncertain[0].to = 100;
  EXPECT_EQ(graph_subtitle(loops_of(1, 0), uncertain, 200),
            "200 scans, 1 loop on; 1 scan not to be trusted, standard deviation up to 0.2 m");
}

}  // namespace
}  // namespace gdtslam
