// Table of the matchers, which find the pose of a scan in the map: names for the parser and the help, and the method of
// each. A new matcher is a value of MatcherKind (config.hpp), a row of this table in matchers.cpp, its code, and a row
// in docs/matchers.md; all other code that knows matchers reads them here. The table is thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "descents.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

/// Points of a scan that are matched; the others are left out.
inline constexpr std::size_t kMostMatchedPoints = 65535;

/// Half the width of the box that a population searches, in edges of the first simplex.
inline constexpr float kBoxSteps = 4.0F;

struct MatcherInfo {
  MatcherKind kind;
  std::string_view name;
  std::string_view doc;  ///< description for the help
  /// One descent from a start to a minimum of (4), on the host. The first edges of `steps` state the error of the
  /// start; null if the matcher only searches windows or follows the slope.
  LocalMinimum (*descend)(Objective& objective, const CellPose& start, const SimplexOptions& steps,
                          const OptimizerConfig& options);
  bool follows_slope = false;    ///< descends by pose_descent, from the first gate to the last; also on a device
  bool always_searches = false;  ///< a window for every scan
  bool proves_windows = false;   ///< searches windows by branch and bound instead of samples
};

/// In the order of MatcherKind.
std::span<const MatcherInfo> matchers();
const MatcherInfo& matcher_info(MatcherKind kind);
std::string_view to_string(MatcherKind kind);
/// All names, in the order of MatcherKind.
std::span<const std::string_view> matcher_names();

}  // namespace gdtslam
