// The positions of a linkage in motion, for every drawing of it. A crank-rocker makes one turn from the start of the
// lift, in the direction that makes lifting the slow stroke. Other linkages with a fully turning crank make one turn;
// the rest move there and back through the first range in which the loop closes. Angles in radians. Thread-safe after
// construction.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/calib/sweep_model.hpp"

namespace gdtslam::calib {

/// Angles in the frame of four_bar.hpp. Points as in the mount, in the plane of x (forward) and z (up), from the
/// rocker's pivot: there the rocker's direction is the elevation.
struct LinkagePosition {
  double crank_rad = 0.0;
  double elevation_rad = 0.0;  ///< continuous along the cycle, without jumps by whole turns
  LinkagePose pose;
  std::array<Point2, 4> joints;  ///< crank's pivot, crank's end, coupler's end, rocker's pivot
  Point2 middle;                 ///< middle of the coupler
};
/// A vector of length 1.
Point2 unit_at(double angle_rad);
/// Converts a point from the frame of four_bar.hpp to the mount.
Point2 place_in_mount(const SweepModel& model, const Point2& place);
/// Empty if the loop does not close.
std::optional<LinkagePosition> position_at(const SweepModel& model, double crank_rad);

class LinkageCycle {
 public:
  /// Throws ConfigError if the loop never closes.
  explicit LinkageCycle(const SweepModel& model);

  [[nodiscard]] const SweepModel& model() const { return model_; }
  [[nodiscard]] GrashofClass grashof() const { return grashof_; }
  /// Empty if it is no crank-rocker.
  [[nodiscard]] const std::optional<CrankRockerReport>& report() const { return report_; }
  [[nodiscard]] double from_rad() const { return from_rad_; }
  [[nodiscard]] double span_rad() const { return span_rad_; }  ///< signed
  [[nodiscard]] bool turns_fully() const { return turns_fully_; }
  /// The crank's turn from the start of the lift to its end, at most the span; the span if there is no lift.
  [[nodiscard]] double lift_span_rad() const;
  /// Positions evenly over the span, both ends included, without those where the loop does not close.
  [[nodiscard]] const std::vector<LinkagePosition>& positions() const { return positions_; }
  /// The same over a part of the span from its start, in this number of steps.
  [[nodiscard]] std::vector<LinkagePosition> stretch(double span_rad, int steps) const;
  /// The two ends of the lift, or of the range.
  [[nodiscard]] const LinkagePosition& begin() const { return begin_; }
  [[nodiscard]] const LinkagePosition& end() const { return end_; }

  /// The lowest elevation.
  [[nodiscard]] double lowest_rad() const { return lowest_rad_; }
  [[nodiscard]] double highest_rad() const { return highest_rad_; }

  /// Whether the laser turns with a fully turning rocker.
  [[nodiscard]] bool sweeps_all_around() const;

  /// Empty if the loop does not close. The elevation is continuous with the cycle's.
  [[nodiscard]] std::optional<LinkagePosition> at(double crank_rad) const;
  /// Crank angle at this share of a film: 0 to 1, even turning, the same at 1 as at 0.
  [[nodiscard]] double crank_at(double share) const;
  /// Turn from the start of the cycle, 0 to |span|.
  [[nodiscard]] double since_begin_rad(double crank_rad) const;
  /// The crank angle at which the elevation has this value while rising or falling, for a crank that turns in
  /// `direction` (+1 counter-clockwise); the nearest if it never does. O(positions).
  [[nodiscard]] double crank_of(double elevation_rad, bool is_rising, int direction) const;
  /// The angle in the lift with coupler and rocker nearest to a right angle.
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
