// The 2D system of figure 5: one scan in, one pose out. Frames: the map's origin is the robot's pose at the first scan.
// One mapper belongs to one thread; its backend may use more. Cost: docs/benchmarks.md.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

/// Seconds spent in each step of figure 5.
struct StageTimes {
  double predict_s = 0.0;
  double match_s = 0.0;  ///< gate, descent and search
  double local_field_s = 0.0;
  double merge_s = 0.0;
};

/// Counts over the run so far.
struct MapperStatistics {
  std::uint64_t scans = 0;
  std::uint64_t matched = 0;           ///< pose from the matcher
  std::uint64_t doubtful = 0;          ///< fell back to the prediction, or matched with weak evidence
  std::uint64_t keyframes = 0;         ///< merged into the map
  std::uint64_t searches = 0;          ///< scans for which a window was searched
  std::uint64_t restarts = 0;          ///< keyframes merged where odometry says, after a long stretch without a match
  std::uint64_t odometry_leaps = 0;    ///< odometry steps too long to be true
  std::uint64_t without_odometry = 0;  ///< scans predicted from the last motion
  std::uint64_t evaluations = 0;
  double path_m = 0.0;
  StageTimes stages;
};

class Mapper {
 public:
  /// Throws ConfigError that names every violation. The backend must outlive the mapper.
  Mapper(const MapperConfig& config, Backend& backend);
  ~Mapper();
  Mapper(const Mapper&) = delete;
  Mapper& operator=(const Mapper&) = delete;

  /// Takes the next scan and the robot's pose by odometry when it was taken (nothing, or a constant, where there is no
  /// odometry) and returns the robot's pose in the map with its evidence. Poses or ranges that are not finite never
  /// reach the map: such a pose counts as no odometry, such a range as no return. Throws InputError when the map would
  /// grow beyond map.max_megacells, with the size needed and the size allowed; the map then stays as it was, the
  /// robot's motion is kept, and mapping may go on.
  MatchResult process(const LaserScan& scan, const std::optional<Pose2>& T_odom_base);

  [[nodiscard]] const MapperConfig& config() const;
  [[nodiscard]] const MapperStatistics& statistics() const;
  /// The global distance transform, on the host.
  [[nodiscard]] const GlobalField& field() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
