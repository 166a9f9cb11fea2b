// The robot's motion from wheels and matches, with how sure either is: wheels are corrected by what they get wrong
// always, their noise is estimated as the log goes, and the pose is that of both, weighed by their covariances. Frame:
// map. Not thread-safe. Cost: some microseconds a scan.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/mapping/match/motion_model.hpp"
#include "engine/mapping/wheels/continued_motion.hpp"
#include "engine/mapping/wheels/known_surfaces.hpp"
#include "engine/mapping/wheels/pose_filter.hpp"
#include "engine/mapping/wheels/wheel_noise.hpp"
#include "engine/mapping/wheels/wheel_scale.hpp"
#include "gdtslam/mapping/match.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {

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
