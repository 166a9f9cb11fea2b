// What a crank-rocker does over one turn: dead points, swing, time ratio, transmission angle. Frame and units of
// four_bar.hpp. Thread-safe, constant time.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/calib/four_bar.hpp"

namespace gdtslam::calib {

struct CrankRockerReport {
  DeadPoint lowest;   ///< of the elevation's direction: where the lift begins
  DeadPoint highest;  ///< where it ends
  double swing_rad = 0.0;
  double lift_share = 0.5;  ///< of the turn that lifting takes, when the crank turns so that it is the slow stroke
  int lift_direction = 1;   ///< of the crank: +1 counter-clockwise
  double time_ratio = 1.0;  ///< slow stroke over quick stroke
  double least_transmission_rad = 0.0;
  double most_rocker_rate = 0.0;  ///< largest |d psi / d phi|
};

/// Throws ConfigError when the linkage is no crank-rocker, with the broken inequality.
CrankRockerReport analyse(const FourBar& bars, Assembly assembly);
/// What a designer should know: a transmission angle below 40 degrees and what that means, a class next to a change
/// point.
std::vector<std::string> remarks(const FourBar& bars, Assembly assembly);

/// A linkage of the paper under one reading of its figure (READING.md's table), nominal or as the paper calibrated it.
struct LinkagePreset {
  std::string_view name;  ///< paper-a, paper-b, paper-c, and each with -calibrated
  std::string_view doc;
  FourBar bars;
};
const std::vector<LinkagePreset>& linkage_presets();
inline constexpr std::string_view kDefaultLinkage = "paper-b";
/// Throws UsageError or ConfigError with the nearest names.
const LinkagePreset& linkage_preset(std::string_view name);

/// What a linkage is designed for.
struct DesignGoal {
  double swing_rad = 1.5707963267948966;
  double min_transmission_rad = 0.6981317007977318;
  double time_ratio = 1.0;  ///< 1: any; else slow over quick stroke, met exactly
  double least_crank_m = 0.03;
  double most_crank_m = 0.05;
};
struct Design {
  FourBar bars;
  CrankRockerReport report;
};
/// The crank-rockers that meet the goal exactly in swing (and time ratio, where asked), the best transmission first,
/// `count` of them spread over the crank's range. Throws ConfigError that says which part of the goal no linkage meets
/// and what the best one reaches.
std::vector<Design> design(const DesignGoal& goal, std::size_t count = 1);

}  // namespace gdtslam::calib
