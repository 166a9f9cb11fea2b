#include <vector>

#include "part.hpp"

namespace gdtslam::reproduce {

namespace {

// In 2D.
std::vector<PartInfo> flat_parts() {
  return {
      {.id = "fig3",
       .label = "Figure 3",
       .title = "A small distance transform",
       .paper = "a grid of ten by ten cells, before and after the distance transform, with the numbers in the cells.",
       .weight_s = 0.1,
       .drives = {},
       .make = make_cells},
      {.id = "fig4",
       .label = "Figure 4",
       .title = "The distance transform of one scan",
       .paper = "the points of one scan, and its distance transform as a grey picture that is bright near obstacles.",
       .weight_s = 0.2,
       .drives = {"one-scan"},
       .make = make_local_scan},
      {.id = "fig7",
       .label = "Figure 7",
       .title = "A floor mapped in 2D, with a loop",
       .paper =
           "the map of an office floor with the robot\u2019s path, which ends where it began, and the global distance "
           "transform behind it.",
       .weight_s = 0.3,
       .drives = {"office-loop"},
       .data_weight_s = 6.5,
       .make = make_loop},
      {.id = "fig8",
       .also = "table1",
       .label = "Figure 8, table 1",
       .title = "Four optimizers against the best solution",
       .paper =
           "how far the poses of PSO, SCE, SIMPSA and simplex are from the global solution, scan by scan and in sum.",
       .weight_s = 36.0,
       .drives = {"office-loop"},
       .data_weight_s = 62.0,
       .make = make_optimizer_errors},
      {.id = "fig9",
       .also = "table2",
       .label = "Figure 9, table 2",
       .title = "Four optimizers against the true position",
       .paper = "how far the robot\u2019s position is from the ground truth with each optimizer, and the time that "
                "each takes.",
       .weight_s = 75.0,
       .drives = {"office-loop", "office-loop-2", "office-loop-3"},
       .data_weight_s = 24.0,
       .make = make_optimizer_positions},
  };
}

// The nodding laser.
std::vector<PartInfo> solid_parts() {
  return {
      {.id = "fig11",
       .label = "Figure 11",
       .title = "The crank-rocker linkage",
       .paper = "the four-bar linkage that nods the laser: one bar turns all the way round, another swings to and fro.",
       .weight_s = 0.3,
       .drives = {},
       .make = make_linkages},
      {.id = "fig12",
       .label = "Figure 12",
       .title = "Three boxes, measured",
       .paper = "three boxes on the floor, their 3D map from one place, and their widths read off its projection to "
                "the floor.",
       .weight_s = 4.0,
       .drives = {"three-boxes"},
       .make = make_boxes},
      {.id = "fig13",
       .label = "Figure 13",
       .title = "Surroundings from one place",
       .paper = "3D maps from two places of a floor, an elevator and a plant among what is seen, and photographs "
                "beside them.",
       .weight_s = 4.0,
       .drives = {"at-elevator", "at-plant"},
       .make = make_standing},
      {.id = "fig14",
       .label = "Figure 14",
       .title = "An office floor in 3D: 3F",
       .paper = "the 2D map of the third floor and its 3D map from a moving robot, without floor and ceiling.",
       .weight_s = 4.0,
       .drives = {"office-3f"},
       .make = make_floor_3f},
      {.id = "fig15",
       .label = "Figure 15",
       .title = "An office floor in 3D: 7F",
       .paper = "the same of the seventh floor.",
       .weight_s = 4.5,
       .drives = {"office-7f"},
       .make = make_floor_7f},
      {.id = "figA",
       .label = "Figure A",
       .title = "The linkage calibrated before a wall",
       .paper = "ranges to a wall over the encoder, measured and as the linkage has them, before and after its lengths "
                "are fitted.",
       .weight_s = 0.2,
       .drives = {"wall"},
       .make = make_calibration},
  };
}

}  // namespace

const std::vector<PartInfo>& part_list() {
  static const std::vector<PartInfo> parts = [] {
    std::vector<PartInfo> all = flat_parts();
    for (const PartInfo& info : solid_parts()) all.push_back(info);
    return all;
  }();
  return parts;
}

}  // namespace gdtslam::reproduce
