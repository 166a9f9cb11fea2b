// Table of the matchers, which find the pose of a scan in the map: names for the parser and the help, and the method of
// each. A new matcher is a value of MatcherKind (config.hpp), a row of this table in matchers.cpp, its code, and a row
// in docs/matchers.md; all other code that knows matchers reads them here. The table is thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "descents.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/match.hpp"
#include "motion_estimate.hpp"

namespace gdtslam {

/// Interface of the matchers. Frame: map. Not thread-safe.
class Matcher {
 public:
  Matcher() = default;
  Matcher(const Matcher&) = delete;
  Matcher& operator=(const Matcher&) = delete;
  virtual ~Matcher() = default;

  /// Best pose of the points (cells, robot frame; at least one, at most kMostPoints) near the prediction, with its
  /// evidence. `search` requests a window even if a descent from the prediction raises no suspicion. Throws DeviceError
  /// if the map's device fails.
  virtual MatchResult match(std::span<const PointCells> points, const Prediction& prediction, bool search) = 0;

  /// With more terms of 16 bits the sums of a verdict could overflow.
  static constexpr std::size_t kMostPoints = 65535;
};

/// Processor that runs a matcher's steps from pose to pose.
enum class MatcherPlace : std::uint8_t { kHost, kDevice };

/// Half the width of the box that a population searches, in edges of the first simplex.
inline constexpr float kBoxSteps = 4.0F;

struct MatcherInfo {
  MatcherKind kind;
  std::string_view name;
  std::string_view doc;  ///< description for the help
  MatcherPlace place;
  std::unique_ptr<Matcher> (*make)(const MapperConfig& config, const GlobalField& map);
  /// One descent from a start to a minimum of (4), on the host. The first edges of `steps` state the error of the
  /// start; null if the matcher only searches windows or follows the slope.
  LocalMinimum (*descend)(Objective& objective, const CellPose& start, const SimplexOptions& steps,
                          const OptimizerConfig& options);
  bool follows_slope = false;   ///< descends by pose_descent, from the first gate to the last
  bool proves_windows = false;  ///< searches windows by branch and bound instead of samples
};

/// In the order of MatcherKind.
std::span<const MatcherInfo> matchers();
const MatcherInfo& matcher_info(MatcherKind kind);
std::string_view to_string(MatcherKind kind);
/// All names, in the order of MatcherKind.
std::span<const std::string_view> matcher_names();

}  // namespace gdtslam
