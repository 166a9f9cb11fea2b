// Motion of a crank-rocker over one turn: dead points, swing, time ratio, transmission angle. Frame and units of
// four_bar.hpp. Thread-safe, constant time.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/calib/four_bar.hpp"

namespace gdtslam::calib {

/// Dead points for an elevation that grows with the rocker's angle psi. If it falls with psi, lift and return are
/// exchanged: the lift begins at `highest`, and the crank turns in the other direction to make it the slow stroke.
struct CrankRockerReport {
  DeadPoint lowest;   ///< least psi: the lift begins here
  DeadPoint highest;  ///< end of the lift
  double swing_rad = 0.0;
  double lift_share =
      0.5;                 ///< share of the turn that lifting takes, when the crank turns so that it is the slow stroke
  int lift_direction = 1;  ///< turn of the crank: +1 counter-clockwise
  double time_ratio = 1.0;  ///< slow stroke over quick stroke
  double least_transmission_rad = 0.0;
  double most_rocker_rate = 0.0;  ///< largest |d psi / d phi|
};

/// Throws ConfigError with the violated inequality if the linkage is no crank-rocker.
CrankRockerReport analyse(const FourBar& bars, Assembly assembly);
/// The least transmission angle of a linkage whose crank turns fully, at one of the two crank angles on the ground
/// line.
double least_transmission_rad(const FourBar& bars);
/// A linkage with a smaller transmission angle transmits force poorly: the usual rule of design [Norton2012].
inline constexpr double kPoorTransmission_rad = 0.6981317007977318;
/// Grashof's inequality with its numbers: "shortest + longest < the other two, 12.4 < 13.5 cm".
std::string inequality_text(const FourBar& bars);
/// Remarks for a designer: a transmission angle below 40 degrees and its effect, a class next to a change point, a
/// rocker much faster than its crank. Throws like analyse().
std::vector<std::string> remarks(const FourBar& bars, Assembly assembly);

/// A linkage of the paper under one reading of its figure (docs/linkage.md), nominal or as the paper calibrated it.
struct LinkagePreset {
  std::string_view name;  ///< paper-a, paper-b, paper-c, and each with -calibrated
  std::string_view doc;
  FourBar bars;
};
const std::vector<LinkagePreset>& linkage_presets();
inline constexpr std::string_view kDefaultLinkage = "paper-b";
/// Throws ConfigError with the known names.
const LinkagePreset& linkage_preset(std::string_view name);

/// The goal of a design.
struct DesignGoal {
  double swing_rad = 1.5707963267948966;
  double min_transmission_rad = kPoorTransmission_rad;
  std::optional<double> time_ratio;  ///< slow over quick stroke, met exactly; empty: any
  double least_crank_m = 0.03;
  double most_crank_m = 0.05;
  /// Default: four times the longest crank, and at most kMostBar_m. A long bar transmits better.
  std::optional<double> longest_bar_m;
};
/// A linkage that meets a goal, and its motion over a turn.
struct Design {
  FourBar bars;
  CrankRockerReport report;
};
/// Crank-rockers that meet the goal exactly in swing (and time ratio, if given), the best transmission first. The first
/// has the shortest crank. The others differ in shape, not only in size: farthest-point sampling [Gonzalez1985] selects
/// them from all that meet the goal. Each is as large as crank and longest bar allow. There are fewer than `count` if
/// the goal allows no more different shapes. With long bars a time ratio of 1 transmits best. About 0.1 s for one, 0.3
/// s for more. Throws ConfigError that names the part of the goal that cannot be met, the best value within reach and
/// the change to make.
std::vector<Design> design(const DesignGoal& goal, std::size_t count = 1);

}  // namespace gdtslam::calib
