// Estimates the robot's motion from wheels and matches with their uncertainty: constant errors of the wheels are
// corrected, their noise is estimated from the log so far, and the pose combines both, weighted by their covariances.
// Frame: map. Not thread-safe. Cost: some microseconds a scan.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/mapping/wheels/continued_motion.hpp"
#include "engine/mapping/wheels/known_surfaces.hpp"
#include "engine/mapping/wheels/pose_filter.hpp"
#include "engine/mapping/wheels/wheel_noise.hpp"
#include "engine/mapping/wheels/wheel_scale.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/match.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {

// Prediction of the robot's pose at the next scan, paper equations (5) and (6): the last estimate moved by the
// odometry's step. If there is no odometry, or it stands still while the scans show motion, or it leaps, the last
// motion continues; odometry that reports late is joined to the pose at which it stopped. Frame: map. Not thread-safe;
// constant time.

/// A possible pose of the robot and its uncertainty.
struct UncertainPose {
  Pose2 T_map_base;
  MotionNoise noise;
};

/// Standard deviations beyond which a pose counts as impossible: chance exceeds it once in a million.
inline constexpr double kReachSigmas = 5.5;

/// True if the robot may be at `T_map_base` according to `expected`.
bool is_within_reach(const UncertainPose& expected, const Pose2& T_map_base);

/// A predicted pose and how far the robot moved to get there.
struct Prediction {
  Pose2 T_map_base;
  double travelled_m = 0.0;
  double turned_rad = 0.0;
  bool by_odometry = false;
  std::optional<MotionNoise> noise = std::nullopt;  ///< estimated noise; without it the configuration's constants count
  std::optional<UncertainPose> otherwise = std::nullopt;  ///< pose if the prediction is wrong
  bool is_hopeless = false;  ///< after many unmatched scans: the search is only near the prediction
};

class MotionModel {
 public:
  /// The robot starts at `T_map_base`.
  explicit MotionModel(const OdometryConfig& config, const Pose2& T_map_base = {})
      : config_(config), T_map_base_(T_map_base) {}

  /// Prediction for the next scan. A pose that is not finite counts as none. If more than a second has passed since the
  /// last scan (`elapsed_s`), the longest odometry step is allowed for each second.
  Prediction predict(const std::optional<Pose2>& T_odom_base, double elapsed_s = 0.0);
  /// Takes the estimated pose; `matched` is false if it is the prediction itself.
  void correct(const Pose2& T_map_base, bool matched);

  /// The last estimate.
  [[nodiscard]] const Pose2& pose() const { return T_map_base_; }
  /// True if the odometry's last step included motion of earlier scans, during which it stood still.
  [[nodiscard]] bool has_caught_up() const { return has_caught_up_; }
  /// Number of steps longer than the odometry may take.
  [[nodiscard]] std::uint64_t leaps() const { return leaps_; }

 private:
  [[nodiscard]] std::optional<Pose2> odometry_motion(const std::optional<Pose2>& T_odom_base, double elapsed_s);

  Pose2 moved_by(const Pose2& motion);

  /// Odometry that moves again after a stop, and may still report the motion in between.
  struct Resumed {
    Pose2 T_map_stop;
    Pose2 T_odom_stop;
    /// True also at the second scan: if poses are interpolated, the first one has only a part of the leap.
    bool may_tell_later = false;
  };

  OdometryConfig config_;
  Pose2 T_map_base_;
  std::optional<Pose2> last_odometry_;
  Pose2 last_motion_;                // last motion of the estimate, in the robot's frame
  std::optional<Pose2> T_map_stop_;  // pose at which the odometry stopped; empty while it moves
  std::optional<Resumed> resumed_;
  bool has_caught_up_ = false;
  bool frozen_ = false;  // the scans showed motion during the stop
  std::uint64_t leaps_ = 0;
};

class MotionEstimate {
 public:
  /// True if the scan fits about as well at the first pose as at the second.
  using FitsAsWell = std::function<bool(const Pose2&, const Pose2&)>;

  /// The first pose: exact at the origin of a map, or an estimate of the robot's pose in a given map.
  enum class FirstPose : std::uint8_t { kExact, kGuess };
  explicit MotionEstimate(FirstPose first = FirstPose::kExact) : stands_(first == FirstPose::kExact) {}

  /// Predicts the next scan's pose with the model by corrected odometry, and states its uncertainty.
  Prediction predict(MotionModel& model, const std::optional<Pose2>& T_odom_base, double stamp_s);
  /// Takes the match of this scan, matched or not. The result gets the pose from both sources. If both cannot be right,
  /// the scan decides, but a weak match that cannot be right is refused.
  void take(MatchResult& result, bool is_matched, const KeptScan& scan, const FitsAsWell& fits_as_well);
  /// The returns of a predicted scan for matching: without the ends of walls (KnownSurfaces::without_wall_ends), if at
  /// least `fewest` are left. Without odometry all returns: nothing else measures the robot's motion.
  [[nodiscard]] std::vector<Point2> points_to_match(const PointScan& scan, int fewest);
  /// Surfaces of the map that grows during mapping. Without a call all surfaces count, as in a complete map.
  KnownSurfaces& known_surfaces() { return known_ ? *known_ : known_.emplace(); }

 private:
  [[nodiscard]] std::optional<Pose2> corrected(const std::optional<Pose2>& T_odom_base);
  [[nodiscard]] UncertainPose going_on(const MotionModel& model) const;
  void settle(MatchResult& result, const KeptScan& scan, const FitsAsWell& fits_as_well);

  WheelNoise wheels_;
  WheelScale scale_;
  ContinuedMotion continued_;
  PoseFilter filter_;
  std::optional<KnownSurfaces> known_;
  std::optional<Pose2> odometry_;  // odometry of the current scan
  std::optional<Pose2> T_odom_last_;
  bool has_moved_ = false;  // true once the odometry has moved
  bool stands_;             // no motion since the map began, by the scans; ends when the odometry measures motion
  Pose2 T_map_last_;        // pose of the scan before
  double stamp_last_s_ = 0.0;
  Pose2 T_odom_corrected_;
  Pose2 step_;                // by odometry, as logged
  UncertainPose going_on_;    // the pose if the motion continues, whatever the odometry says
  bool is_measured_ = false;  // true if odometry measured the step
  MotionNoise noise_;
};

}  // namespace gdtslam
