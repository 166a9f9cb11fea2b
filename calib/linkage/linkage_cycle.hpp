// The positions that a linkage runs through, in the order in which they are best seen: a crank-rocker one turn from
// where the lift begins, in the direction that makes lifting the slow stroke; any other linkage whose crank turns
// fully one turn; the rest there and back through the first stretch in which the loop closes. Whatever draws a linkage
// takes its places from here. Angles in radians. Thread-safe after construction.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/calib/sweep_model.hpp"

namespace gdtslam::calib {

/// Angles in the frame of four_bar.hpp. Places as the linkage stands in the mount, in the plane of x (forward) and z
/// (up), from the rocker's pivot: there the rocker's direction is the elevation.
struct LinkagePosition {
  double crank_rad = 0.0;
  double elevation_rad = 0.0;  ///< without jumps by whole turns along the cycle
  LinkagePose pose;
  std::array<Point2, 4> joints;  ///< crank's pivot, crank's end, coupler's end, rocker's pivot
  Point2 middle;                 ///< middle of the coupler
};
/// A vector of length 1.
Point2 unit_at(double angle_rad);
/// In the mount, of a place in the frame of four_bar.hpp.
Point2 place_in_mount(const SweepModel& model, const Point2& place);
/// Empty if the loop does not close.
std::optional<LinkagePosition> position_at(const SweepModel& model, double crank_rad);

class LinkageCycle {
 public:
  /// Throws ConfigError where the loop closes nowhere.
  explicit LinkageCycle(const SweepModel& model);

  [[nodiscard]] const SweepModel& model() const { return model_; }
  [[nodiscard]] GrashofClass grashof() const { return grashof_; }
  /// Empty unless it is a crank-rocker.
  [[nodiscard]] const std::optional<CrankRockerReport>& report() const { return report_; }
  [[nodiscard]] double from_rad() const { return from_rad_; }
  [[nodiscard]] double span_rad() const { return span_rad_; }  ///< signed
  [[nodiscard]] bool turns_fully() const { return turns_fully_; }
  /// The crank's turn from the lift's begin to its end, at most the span; the span if nothing lifts.
  [[nodiscard]] double lift_span_rad() const;
  /// Evenly over the span, both ends included; places where the loop does not close are left out.
  [[nodiscard]] const std::vector<LinkagePosition>& positions() const { return positions_; }
  /// The same from the cycle's begin through a part of the span, in so many steps.
  [[nodiscard]] std::vector<LinkagePosition> stretch(double span_rad, int steps) const;
  /// The two ends of the lift, or of the stretch.
  [[nodiscard]] const LinkagePosition& begin() const { return begin_; }
  [[nodiscard]] const LinkagePosition& end() const { return end_; }

  /// The lowest elevation.
  [[nodiscard]] double lowest_rad() const { return lowest_rad_; }
  [[nodiscard]] double highest_rad() const { return highest_rad_; }

  /// The laser turns with a rocker that turns fully.
  [[nodiscard]] bool sweeps_all_around() const;

  /// Empty if the loop does not close. The elevation is the one of the cycle.
  [[nodiscard]] std::optional<LinkagePosition> at(double crank_rad) const;
  /// The crank after this share of a film: 0 to 1, at 1 as at 0, turning evenly.
  [[nodiscard]] double crank_at(double share) const;
  /// From the cycle's begin, 0 to |span|.
  [[nodiscard]] double since_begin_rad(double crank_rad) const;
  /// The crank at which the laser looks there while its elevation rises or falls, for a crank that turns in
  /// `direction` (+1 counter-clockwise); where it never does, the nearest. O(positions).
  [[nodiscard]] double crank_of(double elevation_rad, bool is_rising, int direction) const;
  /// In the lift, where coupler and rocker are nearest to a right angle.
  [[nodiscard]] double shown_crank_rad() const;

 private:
  void choose_span();
  void centre_elevations();

  SweepModel model_;
  GrashofClass grashof_;
  std::optional<CrankRockerReport> report_;
  double from_rad_ = 0.0;
  double span_rad_ = 0.0;
  bool turns_fully_ = false;
  std::vector<LinkagePosition> positions_;
  std::vector<LinkagePosition> branches_;
  double lowest_rad_ = 0.0;
  double highest_rad_ = 0.0;
  LinkagePosition begin_;
  LinkagePosition end_;
};

}  // namespace gdtslam::calib
