// Every option of the mapper. The defaults map all our logs; docs/reference/options.md is generated from the tables of
// options (option.hpp), which hold their rows. Lengths in metres, angles in radians; derived values are functions,
// never stored copies.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/option.hpp"

namespace gdtslam {

/// matchers.hpp has their table.
enum class MatcherKind : std::uint8_t { kSimplex, kPso, kSce, kSimpsa, kGaussNewton, kExhaustive, kCertified };
enum class SearchWhen : std::uint8_t { kNever, kSuspect, kKeyframe, kAlways };

/// The field's grid.
struct MapConfig {
  double resolution_m = 0.025;
  double truncation_m = 0.5;  ///< R in metres
  DistanceTransform transform = DistanceTransform::kExact;
  std::int32_t max_megacells = 2048;
  [[nodiscard]] std::uint32_t radius_cells() const;
};

/// Stretch of the path whose map the scans are matched with. A map of the whole path pulls a returning robot to its old
/// walls, right or wrong. Maps of stretches drift, and loops correct the drift.
struct LocalMapConfig {
  double stretch_m = 0.0;  ///< path length; a map holds one to two of them. 0: all of it
};

/// Limits of valid returns.
struct ScanConfig {
  double min_range_m = 0.1;
  double max_range_m = 40.0;
  std::int32_t min_points = 20;
};

/// How a keyframe changes the map, paper equations (9) to (11).
struct MergeConfig {
  MergeRule rule = MergeRule::kWorking;
  double threshold_m = 0.025;
  double kappa = 0.5;
};

/// How far the robot moves or turns from one keyframe to the next.
struct KeyframeConfig {
  double distance_m = 0.25;
  double angle_rad = 0.17453292519943295;
  bool every_scan = false;
};

/// The matcher, and the cost that it minimises.
struct MatchConfig {
  MatcherKind matcher = MatcherKind::kGaussNewton;
  CostForm cost = CostForm::kDistance;
  Interpolation interpolation = Interpolation::kBilinear;
};

/// Parameters of the matchers pso, sce and simpsa, with the values of their sources if these give any.
struct OptimizerConfig {
  std::int32_t particles = 30;  ///< number in a swarm
  std::int32_t complexes = 4;   ///< number in a shuffled population
  std::int32_t moves = 2;       ///< moves of an annealed simplex at one temperature, for each dimension
  double cooling = 1.0;         ///< rate of the annealing's schedule
  std::int32_t max_evaluations = 20000;
  std::int32_t seed = 1;
};

/// Limits for the use of odometry, and its replacement.
struct OdometryConfig {
  bool estimate = false;           ///< noise is estimated from the log; else prior and search state it
  double max_step_m = 5.0;         ///< a longer step between two scans is a fault
  double frozen_m = 0.3;           ///< odometry that stands still while the scans move this far is taken as missing
  double frozen_rad = 0.35;        ///< or turn this far
  double unknown_step_m = 0.2;     ///< without odometry, a motion of at least this much counts as possible
  double unknown_turn_rad = 0.17;  ///< and a turn of at least this much
};

/// Which points count at which stage of a descent, paper equation (8).
struct GateConfig {
  double wide_m = 0.5;
  double final_m = 0.0873;
  double narrowing = 0.5;
  double min_share = 0.4;
};

/// How much the odometry's prediction weighs.
struct PriorConfig {
  double weight = 0.01;       ///< mean cost in cells that one standard deviation away from the prediction adds
  double limit_sigmas = 4.0;  ///< farther away costs no more
  double sigma_m = 0.01;
  double sigma_per_m = 0.1;
  double sigma_rad = 0.035;
  double sigma_per_rad = 0.3;
};

/// When a window of poses is searched, how wide and how dense.
struct SearchConfig {
  SearchWhen when = SearchWhen::kKeyframe;
  double half_m = 0.3;
  double half_per_m = 2.0;
  double half_rad = 0.17453292519943295;
  double half_per_rad = 1.2;
  double step_m = 0.15;
  double step_rad = 0.035;
  double max_half_m = 5.0;
  std::int32_t starts = 3;
  std::int32_t max_points = 96;  ///< a scan is thinned to this many points for the window
  std::int32_t attempts = 3;
  double gap_m = 0.005;              ///< certified: gap of the mean distance
  std::int32_t max_kiloboxes = 200;  ///< certified: boxes in thousands, besides those that cover a window
};

/// When a match is suspect, refused or reported.
struct DoubtConfig {
  double suspect_contradiction = 0.1;  ///< a window is searched if a match is beyond these
  double suspect_overlap = 0.75;
  double suspect_sigmas = 3.0;
  double leap_gain = 0.75;  ///< a pose beyond these must cost less than this share of the near one
  double report_m = 0.25;   ///< accepted matches farther from the odometry than this are reported
  double report_rad = 0.2617993877991494;
  double max_contradiction = 0.3;  ///< a match is refused beyond these
  double min_overlap = 0.25;
  double restart_m = 2.0;  ///< after this much motion without a match the scan is merged at its prediction
};

/// All options of the 2D mapper.
struct MapperConfig {
  MapConfig map;
  LocalMapConfig local;
  ScanConfig scan;
  MergeConfig merge;
  KeyframeConfig keyframe;
  OdometryConfig odometry;
  MatchConfig match;
  OptimizerConfig optimizer;
  GateConfig gate;
  PriorConfig prior;
  SearchConfig search;
  DoubtConfig doubt;
};

/// The table of all options of a configuration; its rows point into it.
std::vector<Option> option_table(MapperConfig& config);
/// Every violation, with path, value and bound; empty when the configuration can be used.
std::vector<std::string> validate(const MapperConfig& config);

}  // namespace gdtslam
