// The robot's motion from wheels and matches, with how sure either is: wheels are corrected by what they get wrong
// always, their noise is estimated as the log goes, and the pose is that of both, weighed by their covariances. Frame:
// map. Not thread-safe. Cost: some microseconds a scan.
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

/// A pose where the robot may be, and how sure that is.
struct UncertainPose {
  Pose2 T_map_base;
  MotionNoise noise;
};

/// Standard deviations beyond which a pose counts as impossible: one of a million is, by chance.
inline constexpr double kReachSigmas = 5.5;

/// Whether the robot may be at `T_map_base` if it should be where `expected` says.
bool is_within_reach(const UncertainPose& expected, const Pose2& T_map_base);

/// A predicted pose and how far the robot moved to get there.
struct Prediction {
  Pose2 T_map_base;
  double travelled_m = 0.0;
  double turned_rad = 0.0;
  bool by_odometry = false;
  std::optional<MotionNoise> noise = std::nullopt;  ///< estimated noise; without it the configuration's constants count
  std::optional<UncertainPose> otherwise = std::nullopt;  ///< pose if the prediction is wrong
  bool is_hopeless = false;  ///< so many scans before this one matched nothing that it is looked for near by alone
};

class MotionModel {
 public:
  /// The robot stands at `T_map_base`.
  explicit MotionModel(const OdometryConfig& config, const Pose2& T_map_base = {})
      : config_(config), T_map_base_(T_map_base) {}

  /// Prediction for the next scan. A pose that is not finite counts as none. Where `elapsed_s` since the scan before is
  /// more than a second, the longest step that the odometry may take counts for each second.
  Prediction predict(const std::optional<Pose2>& T_odom_base, double elapsed_s = 0.0);
  /// Takes the pose that the scan showed; `matched` is false when the prediction itself was kept.
  void correct(const Pose2& T_map_base, bool matched);

  /// The last estimate.
  [[nodiscard]] const Pose2& pose() const { return T_map_base_; }
  /// Whether odometry told in the last step what the robot did in the scans before too, while it stood still.
  [[nodiscard]] bool has_caught_up() const { return has_caught_up_; }
  /// Steps longer than the odometry may take.
  [[nodiscard]] std::uint64_t leaps() const { return leaps_; }

 private:
  [[nodiscard]] std::optional<Pose2> odometry_motion(const std::optional<Pose2>& T_odom_base, double elapsed_s);

  Pose2 moved_by(const Pose2& motion);

  /// Odometry that moves again after a stop, and may still report what it missed meanwhile.
  struct Resumed {
    Pose2 T_map_stop;
    Pose2 T_odom_stop;
    /// Also at the second scan: where poses are interpolated, the first one has only a part of the leap.
    bool may_tell_later = false;
  };

  OdometryConfig config_;
  Pose2 T_map_base_;
  std::optional<Pose2> last_odometry_;
  Pose2 last_motion_;                // last motion of the estimate, in the robot's frame
  std::optional<Pose2> T_map_stop_;  // pose at which the odometry stopped; empty while it moves
  std::optional<Resumed> resumed_;
  bool has_caught_up_ = false;
  bool frozen_ = false;  // the scans moved on from there
  std::uint64_t leaps_ = 0;
};

class MotionEstimate {
 public:
  /// Whether the scan fits about as well at the first pose as at the second.
  using FitsAsWell = std::function<bool(const Pose2&, const Pose2&)>;

  /// Whether the first pose is where the map begins, or what somebody takes for the robot's place in a map.
  enum class FirstPose : std::uint8_t { kExact, kGuess };
  explicit MotionEstimate(FirstPose first = FirstPose::kExact) : stands_(first == FirstPose::kExact) {}

  /// Asks the model for the next scan's pose by corrected odometry, and says how sure it is.
  Prediction predict(MotionModel& model, const std::optional<Pose2>& T_odom_base, double stamp_s);
  /// Takes the match of a scan of these points, matched or not. The result gets the pose from both sources, or is
  /// refused if it is weak and cannot be right; if both cannot be right the scan decides.
  void take(MatchResult& result, bool is_matched, std::span<const Point2> points_base_m,
            const FitsAsWell& fits_as_well);
  /// The returns of a predicted scan that are to be matched: where at least `fewest` are left, without the ends of
  /// walls (KnownSurfaces::without_wall_ends). Without odometry all: nothing else tells how far the robot went.
  [[nodiscard]] std::vector<Point2> points_to_match(const PointScan& scan, int fewest);
  /// Surfaces of the map that grows while mapping. Without a call all surfaces count, as in a map that is whole.
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
  std::optional<Pose2> odometry_;  // odometry of the scan in hand
  std::optional<Pose2> T_odom_last_;
  bool has_moved_ = false;  // the odometry, ever
  bool stands_;             // since the map began, as far as scans tell; what odometry measures is believed instead
  Pose2 T_map_last_;        // pose of the scan before
  double stamp_last_s_ = 0.0;
  Pose2 T_odom_corrected_;
  Pose2 step_;                // by odometry, as it was logged
  UncertainPose going_on_;    // the pose if the motion goes on, whatever the odometry says
  bool is_measured_ = false;  // by odometry
  MotionNoise noise_;
};

}  // namespace gdtslam
