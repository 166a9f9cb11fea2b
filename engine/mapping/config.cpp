#include "gdtslam/mapping/config.hpp"
#include "gdtslam/core/units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "engine/mapping/match/matchers.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"

namespace gdtslam {
namespace {

using namespace std::string_view_literals;

constexpr std::array kTransforms{"exact"sv, "jump-flood"sv};
constexpr std::array kMergeRules{"working"sv, "literal"sv};
constexpr std::array kCostForms{"distance"sv, "squared"sv};
constexpr std::array kInterpolations{"bilinear"sv, "nearest"sv};
constexpr std::array kSearchTimes{"never"sv, "suspect"sv, "keyframe"sv, "always"sv};

std::vector<Option> map_options(MapperConfig& c) {
  return {
      {"map.resolution", "Edge of a cell of the map", Unit::kMetre, 0.005, 1.0, &c.map.resolution_m},
      {"map.truncation", "Distances to obstacles are kept up to this radius, which may be 255 cells at most",
       Unit::kMetre, 0.01, 255.0, &c.map.truncation_m},
      {"map.transform",
       "How the distances of a keyframe are computed: exact, or by jump flooding, which errs now and then", Unit::kNone,
       0, 0, Choice(c.map.transform, kTransforms), kAdvanced},
      {"map.max_megacells", "Most cells that the map may have, in units of 2^20", Unit::kNone, 1, 16384,
       &c.map.max_megacells},
      {"local.stretch", "Path after which scans are matched with a younger map; 0 keeps one map of all", Unit::kMetre,
       0.0, 1000.0, &c.local.stretch_m, kAdvanced},
      {"scan.min_range", "Shorter ranges count as no return", Unit::kMetre, 0.0, 100.0, &c.scan.min_range_m},
      {"scan.max_range", "Ranges at or above this count as no return; the log's own limit counts too", Unit::kMetre,
       0.1, 1000.0, &c.scan.max_range_m},
      {"scan.min_points", "A scan with fewer returns than this is not matched", Unit::kNone, 3, 100000,
       &c.scan.min_points, kAdvanced},
      {"merge.rule",
       "Form of the merging rule, equations (9) to (11) of the paper: the one that works, or literally as printed",
       Unit::kNone, 0, 0, Choice(c.merge.rule, kMergeRules), kAdvanced},
      {"merge.threshold", "Threshold of the merging rule, equation (9): cells that agree within it are averaged",
       Unit::kMetre, 0.0, 10.0, &c.merge.threshold_m},
      {"merge.kappa", "Share of merge.threshold that a new obstacle is entered with, equation (11)", Unit::kShare, 0.0,
       1.0, &c.merge.kappa, kAdvanced},
      {"keyframe.distance", "A scan is merged into the map when the robot has moved this far since the last keyframe",
       Unit::kMetre, 0.0, 100.0, &c.keyframe.distance_m},
      {"keyframe.angle", "A scan is merged into the map when the robot has turned this far since the last keyframe",
       Unit::kRadian, 0.0, 3.2, &c.keyframe.angle_rad},
      {"keyframe.every_scan", "Whether every scan is merged into the map, however little the robot moved", Unit::kNone,
       0, 1, &c.keyframe.every_scan, kAdvanced},
  };
}

std::string matcher_doc() {
  std::string text = "How a scan is matched with the map, equation (4): ";
  for (const MatcherInfo& matcher : matchers()) {
    if (&matcher != &matchers().front()) text += "; ";
    text.append(matcher.name).append(", ").append(matcher.doc);
  }
  return text;
}

std::vector<Option> match_options(MapperConfig& c) {
  static const std::string matcher_text = matcher_doc();
  return {
      {"match.matcher", matcher_text, Unit::kNone, 0, 0, Choice(c.match.matcher, matcher_names())},
      {"match.cost",
       "What is minimised: the distances of the points to the map, or their squares as equation (1) prints them",
       Unit::kNone, 0, 0, Choice(c.match.cost, kCostForms), kAdvanced},
      {"match.interpolation", "How the distance field is read between the centres of its cells", Unit::kNone, 0, 0,
       Choice(c.match.interpolation, kInterpolations), kAdvanced},
      {"gate.wide",
       "First gate of equation (8): points farther from the map do not count; in a window's samples they count as it",
       Unit::kMetre, 0.01, 10.0, &c.gate.wide_m, kAdvanced},
      {"gate.final", "Last gate of equation (8), 20 m * sin 0.25 deg in the paper", Unit::kMetre, 0.01, 10.0,
       &c.gate.final_m, kAdvanced},
      {"gate.narrowing", "Factor by which each gate is narrower than the one before it", Unit::kShare, 0.05, 0.95,
       &c.gate.narrowing, kAdvanced},
      {"gate.min_share", "Least share of the points that a gate leaves to the matcher simplex", Unit::kShare, 0.0, 1.0,
       &c.gate.min_share, kAdvanced},
      {"prior.weight", "Mean cost, in cells, of a pose that is one standard deviation from the prediction", Unit::kCell,
       0.0, 10.0, &c.prior.weight, kAdvanced},
      {"prior.limit", "Standard deviations from the prediction beyond which the prior costs no more", Unit::kNone, 0.1,
       1000.0, &c.prior.limit_sigmas, kAdvanced},
      {"prior.sigma", "Standard deviation of the predicted position of a robot that rests", Unit::kMetre, 0.001, 100.0,
       &c.prior.sigma_m},
      {"prior.sigma_per_metre",
       "By how much the standard deviation of the predicted position grows per metre of motion", Unit::kShare, 0.0,
       10.0, &c.prior.sigma_per_m},
      {"prior.sigma_angle", "Standard deviation of the predicted heading of a robot that rests", Unit::kRadian, 0.0001,
       10.0, &c.prior.sigma_rad},
      {"prior.sigma_angle_per_radian",
       "By how much the standard deviation of the predicted heading grows per angle turned", Unit::kShare, 0.0, 10.0,
       &c.prior.sigma_per_rad},
  };
}

std::vector<Option> optimizer_options(MapperConfig& c) {
  return {
      {"optimizer.particles", "Particles in the swarm of the matcher pso", Unit::kNone, 2, 65535,
       &c.optimizer.particles, kAdvanced},
      {"optimizer.complexes", "Complexes of the matcher sce, of seven points each", Unit::kNone, 1, 1000,
       &c.optimizer.complexes, kAdvanced},
      {"optimizer.moves", "Moves of the matcher simpsa at one temperature, for each dimension", Unit::kNone, 1, 100000,
       &c.optimizer.moves, kAdvanced},
      {"optimizer.cooling", "How fast the matcher simpsa cools, its delta", Unit::kNone, 0.001, 1000.0,
       &c.optimizer.cooling, kAdvanced},
      {"optimizer.max_evaluations", "Poses that pso, sce and simpsa evaluate at most in one descent, about",
       Unit::kNone, 1, 100000000, &c.optimizer.max_evaluations, kAdvanced},
      {"optimizer.seed", "Seed of the random numbers of pso, sce and simpsa", Unit::kNone, 0, 2147483647,
       &c.optimizer.seed, kAdvanced},
  };
}

std::vector<Option> search_options(MapperConfig& c) {
  return {
      {"search.when", "When a window of poses is searched; the matcher exhaustive always does", Unit::kNone, 0, 0,
       Choice(c.search.when, kSearchTimes)},
      {"search.half_width", "Half width of the window that is searched around a robot at rest", Unit::kMetre, 0.0,
       100.0, &c.search.half_m},
      {"search.half_width_per_metre", "By how much the half width of the searched window grows per metre of motion",
       Unit::kShare, 0.0, 10.0, &c.search.half_per_m, kAdvanced},
      {"search.half_angle", "Half angle of the window that is searched around a robot at rest", Unit::kRadian, 0.0,
       3.15, &c.search.half_rad},
      {"search.half_angle_per_radian", "By how much the half angle of the searched window grows per angle turned",
       Unit::kShare, 0.0, 10.0, &c.search.half_per_rad, kAdvanced},
      {"search.step", "Distance between two samples of the searched window", Unit::kMetre, 0.005, 10.0,
       &c.search.step_m, kAdvanced},
      {"search.step_angle", "Angle between two samples of the searched window", Unit::kRadian, 0.0005, 3.15,
       &c.search.step_rad, kAdvanced},
      {"search.starts", "Best local minima of the searched window that are polished", Unit::kNone, 1, 16,
       &c.search.starts, kAdvanced},
      {"search.max_half_width", "Half width beyond which the searched window never grows", Unit::kMetre, 0.0, 1000.0,
       &c.search.max_half_m, kAdvanced},
      {"search.max_points", "Points that a scan is thinned to before a window is searched", Unit::kNone, 8,
       kMostMatchedPoints, &c.search.max_points, kAdvanced},
      {"search.attempts", "Windows tried, each twice as large as the last, while the match is in doubt", Unit::kNone, 1,
       8, &c.search.attempts, kAdvanced},
      {"search.gap",
       "What the matcher certified proves: no pose of a window has a mean distance smaller by more than this",
       Unit::kMetre, 0.0, 1.0, &c.search.gap_m, kAdvanced},
      {"search.max_kiloboxes",
       "Boxes, in thousands, beside those that cover the window, after which the matcher certified gives it up",
       Unit::kNone, 1, 1000000, &c.search.max_kiloboxes, kAdvanced},
  };
}

std::vector<Option> doubt_options(MapperConfig& c) {
  return {
      {"odometry.estimate",
       "Whether the noise of the odometry is estimated as the log goes; else prior and search state it", Unit::kNone, 0,
       1, &c.odometry.estimate},
      {"odometry.max_step", "Longest step of the odometry between two scans; a longer one is a fault and is not used",
       Unit::kMetre, 0.01, 1000.0, &c.odometry.max_step_m, kAdvanced},
      {"odometry.frozen", "Odometry that stands still while the scans move this far counts as missing", Unit::kMetre,
       0.0, 1000.0, &c.odometry.frozen_m, kAdvanced},
      {"odometry.frozen_angle", "Odometry that stands still while the scans turn this far counts as missing",
       Unit::kRadian, 0.0, 100.0, &c.odometry.frozen_rad, kAdvanced},
      {"odometry.unknown_step", "Motion between two scans that is allowed for where there is no odometry", Unit::kMetre,
       0.0, 100.0, &c.odometry.unknown_step_m, kAdvanced},
      {"odometry.unknown_turn", "Turn between two scans that is allowed for where there is no odometry", Unit::kRadian,
       0.0, 3.15, &c.odometry.unknown_turn_rad, kAdvanced},
      {"doubt.suspect_contradiction",
       "A window is searched when a larger share of the points near known obstacles lies beside them", Unit::kShare,
       0.0, 1.0, &c.doubt.suspect_contradiction, kAdvanced},
      {"doubt.suspect_overlap",
       "A window is searched when a smaller share of the points than this lies within the final gate", Unit::kShare,
       0.0, 1.0, &c.doubt.suspect_overlap, kAdvanced},
      {"doubt.suspect_sigmas",
       "A window is searched when the pose is more standard deviations than this from the prediction", Unit::kNone, 0.0,
       1000.0, &c.doubt.suspect_sigmas, kAdvanced},
      {"doubt.leap_gain",
       "A pose beyond doubt.suspect_sigmas is taken only where it costs less than this share of the near one",
       Unit::kShare, 0.01, 1.0, &c.doubt.leap_gain, kAdvanced},
      {"doubt.report_distance", "An accepted match this far from where the odometry puts it is reported as doubtful",
       Unit::kMetre, 0.0, 1000.0, &c.doubt.report_m},
      {"doubt.report_angle",
       "An accepted match turned this far from where the odometry puts it is reported as doubtful", Unit::kRadian, 0.0,
       3.2, &c.doubt.report_rad},
      {"doubt.max_contradiction", "A match with a larger share of its points beside the obstacles near them is refused",
       Unit::kShare, 0.0, 1.0, &c.doubt.max_contradiction, kAdvanced},
      {"doubt.min_overlap", "A match with a smaller share of its points within the final gate is refused", Unit::kShare,
       0.0, 1.0, &c.doubt.min_overlap, kAdvanced},
      {"doubt.restart", "Motion without a match after which a scan is merged where the odometry says", Unit::kMetre,
       0.1, 1000.0, &c.doubt.restart_m, kAdvanced},
  };
}

constexpr std::int64_t kMostSamples = std::int64_t{1} << 25U;

// Poses of the largest window that a configuration allows.
std::int64_t most_samples(const MapperConfig& config) {
  const SearchConfig& s = config.search;
  const auto side = static_cast<std::int64_t>(2.0 * std::ceil(s.max_half_m / s.step_m)) + 1;
  const auto angles = static_cast<std::int64_t>(2.0 * std::ceil(kPi / s.step_rad)) + 1;
  return side > 100000 ? kMostSamples + 1 : side * side * angles;
}

constexpr std::array kFreedoms{"plane"sv, "space"sv};
constexpr std::array kPoseInterpolations{"linear"sv, "geodesic"sv, "odometry"sv};
constexpr std::array kForms{"working"sv, "literal"sv};

}  // namespace

std::uint32_t MapConfig::radius_cells() const {
  return static_cast<std::uint32_t>(std::lround(truncation_m / resolution_m));
}

std::vector<Option> option_table(MapperConfig& config) {
  std::vector<Option> table;
  for (const auto& options : {map_options, match_options, optimizer_options, search_options, doubt_options}) {
    const std::vector<Option> part = options(config);
    table.insert(table.end(), part.begin(), part.end());
  }
  return table;
}

std::vector<std::string> validate(const MapperConfig& config) {
  MapperConfig copy = config;
  std::vector<std::string> found = violations(option_table(copy));
  if (found.empty() && (config.map.radius_cells() < 1 || config.map.radius_cells() > 255)) {
    found.push_back("map.truncation is " + std::to_string(config.map.radius_cells()) +
                    " cells of map.resolution; it must be 1 to 255 cells");
  }
  if (found.empty() && config.map.truncation_m <= 2.0 * config.gate.final_m) {
    found.emplace_back("map.truncation must be larger than twice gate.final, or no scan could contradict the map");
  }
  if (found.empty() && most_samples(config) > kMostSamples) {
    found.emplace_back(
        "search.half_width, search.max_half_width, search.step and search.step_angle ask for windows of more than " +
        std::to_string(kMostSamples) + " poses");
  }
  if (found.empty() && config.gate.final_m > config.gate.wide_m) {
    found.emplace_back("gate.final must not be larger than gate.wide");
  }
  const bool has_bounds =
      config.match.cost == CostForm::kDistance && config.match.interpolation == Interpolation::kBilinear;
  if (const MatcherInfo& matcher = matcher_info(config.match.matcher); matcher.proves_windows && !has_bounds) {
    found.push_back("match.matcher " + std::string(matcher.name) +
                    " needs match.cost distance and match.interpolation bilinear");
  }
  return found;
}

MapperConfig nodding_mapper_config(MapperConfig config, const NoddingConfig& nodding) {
  config.prior.limit_sigmas = nodding.prior_limit_sigmas;
  config.odometry.max_step_m = 1000.0;  // the largest value of the option
  return config;
}

std::vector<Option> option_table(NoddingConfig& config) {
  return {
      {"nod.horizontal", "Scans whose elevations all lie within this angle of horizontal fix the pose", Unit::kRadian,
       0.0001, 0.2, &config.horizontal_rad},
      {"nod.interpolation",
       "How poses between two fixes are found, equation (13): linear, geodesic, or by the odometry", Unit::kNone, 0, 0,
       Choice(config.interpolation, kPoseInterpolations), kAdvanced},
      {"nod.form",
       "Form of equation (14): the one that works, or literally as printed, whose translation is scaled by the height",
       Unit::kNone, 0, 0, Choice(config.form, kForms), kAdvanced},
      {"nod.smooth",
       "Whether points at the height of walls help to place the robot between two fixes, where poses follow the "
       "odometry",
       Unit::kNone, 0, 1, &config.smoother.is_on},
      {"nod.band_up", "Points that nod.smooth takes as those of walls lie at most this much higher than the map",
       Unit::kMetre, 0.0, 100.0, &config.smoother.band_up_m, kAdvanced},
      {"nod.band_floor", "Points that nod.smooth takes as those of walls lie at least this much above the floor",
       Unit::kMetre, -100.0, 100.0, &config.smoother.above_floor_m, kAdvanced},
      {"nod.prior_limit",
       "Takes the place of prior.limit where the laser nods: metres lie between two fixes, and what looks alike far "
       "away is no match",
       Unit::kNone, 0.1, 1000.0, &config.prior_limit_sigmas, kAdvanced},
      {"nod.poses",
       "What poses are found: in the plane, or in space with height, roll and pitch, for floors with ramps and sills "
       "and for "
       "robots that sway",
       Unit::kNone, 0, 0, Choice(config.dof, kFreedoms), kAdvanced},
      {"nod.max_blind", "Time without a horizontal scan after which poses come from the odometry alone", Unit::kSecond,
       0.1, 3600.0, &config.max_blind_s, kAdvanced},
  };
}

}  // namespace gdtslam
