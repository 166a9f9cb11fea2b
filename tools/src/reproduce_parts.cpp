#include <vector>

#include "reproduce_part.hpp"

namespace gdtslam::reproduce {

const std::vector<PartInfo>& part_list() {
  static const std::vector<PartInfo> kParts{
      {"fig3",
       "Figure 3",
       "A small distance transform",
       "a grid of ten by ten cells, before and after the distance transform, with the numbers in the cells.",
       0.5,
       {},
       false,
       make_cells},
      {"fig11",
       "Figure 11",
       "The crank-rocker linkage",
       "the four-bar linkage that nods the laser: one bar turns all the way round, another swings to and fro.",
       4.0,
       {},
       false,
       make_linkages},
  };
  return kParts;
}

}  // namespace gdtslam::reproduce
