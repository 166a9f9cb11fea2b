// The goal of `gdtslam linkage --design` as the command line has it. Thread-safe.
#pragma once

#include <string>

#include "gdtslam/calib/crank_rocker.hpp"

namespace gdtslam {

/// Options as text, so that their units can be told; empty: the default.
struct GoalText {
  std::string swing;
  std::string min_transmission;
  std::string crank;  ///< "3..5cm" or one length
  std::string time_ratio;
  std::string longest;
};

/// Throws UsageError that names the option.
calib::DesignGoal goal_of(const GoalText& text);

}  // namespace gdtslam
