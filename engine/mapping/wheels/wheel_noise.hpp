// Estimates the noise of the wheels from accepted matches as the log is read: constant errors are corrected, the rest
// is noise. Errors of wheels grow with the path as a random walk does, those of matches do not; so the variance of
// their difference over longer and longer stretches separates the two. Robust: uses quantiles, so that a slip or a
// wrong match is one of many. Not thread-safe. Cost: some microseconds a scan.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "engine/mapping/wheels/continued_motion.hpp"
#include "engine/mapping/wheels/wheel_bias.hpp"
#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// A random walk of the wheels, and the error that matches add to every difference.
struct WheelErrors {
  double slip_m = 0.1;    ///< metres per root of a metre
  double slip_rad = 0.2;  ///< radians per root of half the metres and the radians turned
  double match_m = 0.0;   ///< excess over chance: next to bad wheels little of it shows
  double match_rad = 0.0;
  std::size_t stretches = 0;  ///< number of stretches of the estimate
};

class WheelNoise {
 public:
  /// The robot's pose by odometry at a scan, and its pose by an accepted match; empty if nothing is to be learnt from
  /// the match. Without odometry all begins anew. If the match does not know the way, only its heading is learnt from.
  void take(const std::optional<Pose2>& T_odom_base, const std::optional<Pose2>& T_map_base, bool knows_way = true);
  /// Learns nothing across this place; earlier knowledge stays.
  void break_off();

  [[nodiscard]] const WheelErrors& errors() const { return errors_; }
  /// Sets the distances of a bias, from WheelScale or a graph; motions are corrected by them from now on.
  void set_distance(const WheelBias& bias) {
    bias_.distance = bias.distance;
    bias_.sigma_distance = bias.sigma_distance;
  }
  [[nodiscard]] const WheelBias& bias() const { return bias_; }
  /// A motion by the wheels, corrected for their constant errors.
  [[nodiscard]] Pose2 corrected(const Pose2& by_wheels) const;
  /// Noise of a corrected motion of this length and turn.
  [[nodiscard]] MotionNoise of(double travelled_m, double turned_rad) const;

 private:
  /// Poses of both sources at one time.
  struct Mark {
    Pose2 T_odom_base;
    Pose2 T_map_base;
    double path_m = 0.0;
    double turned_rad = 0.0;
    double forward_m = 0.0;  // signed, as the next
    double turn_rad = 0.0;
    bool knows_way = true;
    std::size_t breaks = 0;  // breaks of the path before it
  };
  /// Sums over all stretches of a number of marks: the median path, and the variance of the difference.
  struct Spread {
    double path = 0.0;
    double variance = 0.0;
    double weight = 0.0;
  };
  struct Line {
    double slope = 0.0;
    double level = 0.0;
    double sure_level = 0.0;  // beyond chance
  };
  void estimate();
  [[nodiscard]] std::vector<WheelStretch> stretches() const;
  [[nodiscard]] std::vector<Pose2> corrected_marks() const;
  void spreads_over(std::size_t marks, const std::vector<Pose2>& odometry, std::vector<Spread>& metres,
                    std::vector<Spread>& radians) const;
  static Line fit(const std::vector<Spread>& spreads, double slope_before);

  std::deque<Mark> marks_;
  std::optional<Pose2> last_;
  double path_m_ = 0.0;
  double turned_rad_ = 0.0;
  double forward_m_ = 0.0;
  double turn_rad_ = 0.0;
  std::size_t taken_ = 0;
  std::size_t breaks_ = 0;
  WheelErrors errors_;
  WheelBias bias_;
};

}  // namespace gdtslam
