// The goal of `gdtslam linkage --design` as the command line has it. Thread-safe.
#pragma once

#include <string>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/units.hpp"

namespace gdtslam {

/// Options as text, so that their units can be told; empty: the default.
struct GoalText {
  std::string swing;
  std::string min_transmission;
  std::string crank;  ///< "3..5cm" or one length
  std::string time_ratio;
  std::string longest;
};

/// Throws UsageError that names the option. Angles and lengths need a unit: 90 without one would be radians.
calib::DesignGoal goal_of(const GoalText& text);
/// A quantity with its unit, for the option of that name. Throws UsageError.
double quantity_of(const std::string& option, const std::string& text, Unit unit);

}  // namespace gdtslam
