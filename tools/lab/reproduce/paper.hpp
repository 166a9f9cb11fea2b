// Tables 1 and 2 of the paper: what it prints of each optimizer, and how ours are named beside them.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/mapping/evaluation.hpp"
#include "tools/lab/matchers/methods.hpp"

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

}  // namespace gdtslam::reproduce
