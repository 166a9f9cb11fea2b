// What the paper prints in tables 1 and 2 and how ours are named beside it, and what decides the verdicts of parts that
// take long to make, apart from making them. Thread-safe.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/measuring/measure_table.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "tools/lab/matchers/methods.hpp"
#include "tools/lab/reproduce/part.hpp"

namespace gdtslam::reproduce {

/// What tables 1 and 2 print of an optimizer; "Y max" of table 1 repeats X and contradicts the distances, so it is left
/// out. Centimetres and degrees.
struct PaperColumn {
  MatcherKind method;
  std::string_view name;
  std::string_view distance;
  double distance_max = 0.0;
  std::string_view x;
  std::string_view y;
  std::string_view theta;
  std::string_view truth;
  double truth_mean = 0.0;
  double truth_max = 0.0;
  std::string_view time;
  double time_least = 1.0;  ///< as a multiple of simplex's; two readings of a damaged number
  double time_most = 1.0;
};
inline constexpr std::array<PaperColumn, 4> kPaper{{
    {MatcherKind::kPso, "PSO", "0.77 \u00b1 0.81", 6.4657, "0.34 \u00b1 0.35", "0.61 \u00b1 0.79", "0.094 \u00b1 0.09",
     "2.81 \u00b1 1.64", 2.8142, 6.8941, "99.72", 99.7164, 99.7164},
    {MatcherKind::kSce, "SCE", "0.74 \u00b1 0.67", 4.1131, "0.35 \u00b1 0.31", "0.57 \u00b1 0.67", "0.099 \u00b1 0.09",
     "3.55 \u00b1 1.69", 3.5518, 7.7390, "9.10 or 8.09", 8.0873, 9.0972},
    {MatcherKind::kSimpsa, "SIMPSA", "0.83 \u00b1 0.83", 6.1106, "0.36 \u00b1 0.31", "0.65 \u00b1 0.85",
     "0.10 \u00b1 0.088", "4.20 \u00b1 3.10", 4.1986, 11.6108, "4.20", 4.1993, 4.1993},
    {MatcherKind::kSimplex, "Simplex", "0.80 \u00b1 0.82", 5.9534, "0.36 \u00b1 0.31", "0.63 \u00b1 0.83",
     "0.102 \u00b1 0.09", "3.66 \u00b1 2.68", 3.6582, 9.0126, "1"},
}};

/// "PSO" as the paper has it, else the name that `--matcher` knows.
std::string label_of(MatcherKind method);
/// "0.77 \u00b1 0.81", centimetres.
std::string cm_text(const ErrorSummary& error_m);
/// Names by rising value: "PSO, SCE, simplex".
std::string ranking(const std::vector<std::string>& names, const std::vector<double>& values);

/// Table 2: an optimizer's time as a multiple of simplex's, `ratio`, held against the paper's factor.
Row time_row(const PaperColumn& paper, double ratio);

/// Figure 12: width, and where the boxes were measured in space the height too: only heights move with the linkage.
std::vector<Row> box_rows(const Measurement& measured);

/// Figures 14 and 15: how far the contours of a 2D map, of the 3D map from raised scans and of the truth agree, in the
/// plane to 5 cm. All in the map's frame; O(n log n) in the points.
struct ContourShares {
  double of_map = 0.0;    ///< of the occupied cells: a raised point is near
  double of_cloud = 0.0;  ///< of the cells over which raised points span 1 m of height: an occupied one is near
  double of_truth = 0.0;  ///< of the cells with true surfaces: a raised point is near
};
ContourShares contour_shares(const OccupancyMap& map, std::span<const CloudPoint> cloud, std::span<const Point2> truth);

}  // namespace gdtslam::reproduce
