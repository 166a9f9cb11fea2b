// Table of the matchers, which find the pose of a scan in the map: names for the parser and the help, and how each
// looks for a pose. A new matcher is a value of MatcherKind (config.hpp), a row of this table in matchers.cpp, its
// code, and a row in docs/matchers.md; all other code that knows matchers reads them here. The table is thread-safe.
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

/// Frame: map. Not thread-safe.
class Matcher {
 public:
  Matcher() = default;
  Matcher(const Matcher&) = delete;
  Matcher& operator=(const Matcher&) = delete;
  virtual ~Matcher() = default;

  /// Best pose of the points (cells, robot frame; at least one, at most kMostPoints) near the prediction, with its
  /// evidence. `search` asks for a window even when a descent from the prediction raises no suspicion. Throws
  /// DeviceError where the map's device fails.
  virtual MatchResult match(std::span<const PointCells> points, const Prediction& prediction, bool search) = 0;

  /// More terms of 16 bits could overflow the sums of a verdict.
  static constexpr std::size_t kMostPoints = 65535;
};

/// Processor that a matcher walks from pose to pose on.
enum class MatcherPlace : std::uint8_t { kHost, kDevice };

/// Half the width of the box that a population looks into, in edges of the first simplex.
inline constexpr float kBoxSteps = 4.0F;

struct MatcherInfo {
  MatcherKind kind;
  std::string_view name;
  std::string_view doc;  ///< description for the help
  MatcherPlace place;
  std::unique_ptr<Matcher> (*make)(const MapperConfig& config, const GlobalField& map);
  /// One walk from a start to a minimum of (4), on the host. The first edges of `steps` tell how far off the start may
  /// be; null where the matcher knows windows only.
  LocalMinimum (*descend)(Objective& objective, const CellPose& start, const SimplexOptions& steps,
                          const OptimizerConfig& options);
  bool is_refined = false;      ///< the end of the walk, by robust least squares
  bool proves_windows = false;  ///< windows by branch and bound instead of samples
};

/// In the order of MatcherKind.
std::span<const MatcherInfo> matchers();
const MatcherInfo& matcher_info(MatcherKind kind);
std::string_view to_string(MatcherKind kind);
/// All names, in the order of MatcherKind.
std::span<const std::string_view> matcher_names();

}  // namespace gdtslam
