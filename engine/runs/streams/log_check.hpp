// Contents and faults of a log, from one pass over its records; the work of `gdtslam doctor`. Metres,
// radians, seconds. Memory is bounded: faults are counted, the first of each kind are listed, ranges go into a
// histogram. One check belongs to one thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/runs/streams/no_return.hpp"
#include "engine/runs/streams/unit_check.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

/// Messages of the mount that nods the laser, crank or elevation, and oddities that show in them without a linkage.
struct NodCheck {
  std::uint64_t encoder_records = 0;
  std::uint64_t tilt_records = 0;
  double mean_rate_hz = 0.0;      ///< rate of the more frequent kind
  double longest_gap_s = 0.0;     ///< between two messages
  double longest_gap_at_s = 0.0;  ///< stamp of the message before it
  std::uint64_t backward_stamps = 0;
  std::int64_t lowest_ticks = 0;
  std::int64_t highest_ticks = 0;
  double lowest_tilt_rad = 0.0;
  double highest_tilt_rad = 0.0;

  [[nodiscard]] bool has_records() const { return encoder_records + tilt_records > 0; }
  /// Advice for the user, a sentence each.
  [[nodiscard]] std::vector<std::string> suggestions() const;
};

class NodChecker {
 public:
  void add(const Encoder& message);
  void add(const Tilt& message);
  [[nodiscard]] NodCheck finish() const;

 private:
  void add_time(double stamp_s);

  NodCheck check_;
  std::optional<double> first_s_;
  double last_s_ = 0.0;
};

/// Bounds beyond which a step of the odometry is impossible: this much at once, and this much more per second.
struct StepBounds {
  double distance_m = 0.1;
  double speed_m_s = 3.0;
  double angle_rad = 0.17453292519943295;     ///< 10 degrees
  double turn_rate_rad_s = 3.14159265358979;  ///< 180 degrees a second
  double longest_s = 2.0;                     ///< a longer pause allows no larger step
  double unknown_s = 0.25;                    ///< assumed if the clock stood still or went backward
};

/// True if no robot moves that far in that time.
bool is_impossible(const Pose2& step, double step_s, const StepBounds& bounds);

/// An oddity in the log: index of its scan from 0, stamp, and sizes that depend on the kind.
struct LogEvent {
  std::uint64_t scan = 0;
  double stamp_s = 0.0;
  double time_step_s = 0.0;
  double distance_m = 0.0;
  double angle_rad = 0.0;
};

/// Events of one kind: how many, the first few, the largest.
struct EventList {
  static constexpr std::size_t kMostListed = 5;
  std::uint64_t count = 0;
  std::vector<LogEvent> first;
  double largest = 0.0;
  void add(const LogEvent& event, double size);
};

/// Layout of the beams and the number of scans with it.
struct BeamLayout {
  std::size_t beams = 0;
  double first_bearing_rad = 0.0;
  double step_rad = 0.0;
  double max_range_m = 0.0;  ///< limit that the log states; 0: none
  std::uint64_t scans = 0;
  std::size_t laser = 0;  ///< the laser of these scans
};

/// Place of one of the lasers on the robot.
struct LaserMount {
  std::size_t laser = 0;  ///< its number in the log
  std::uint64_t scans = 0;
  Pose2 T_base_laser;         ///< mount of its first scan
  std::uint64_t changes = 0;  ///< scans whose mount differs by more than 1 mm or 0.1 degrees
};

/// Statistics of the ranges.
struct RangeStatistics {
  std::uint64_t beams = 0;
  std::uint64_t not_finite = 0;       ///< or zero
  std::uint64_t returns = 0;          ///< finite, positive, below every no-return value
  std::vector<double> no_return_m;    ///< constants that stand for "no return", to a centimetre
  std::uint64_t no_return_count = 0;  ///< beams with such a constant
  double shortest_m = 0.0;
  double median_m = 0.0;
  double longest_m = 0.0;
};

/// Whether the mapper can use the scan: it has scan.min_points returns.
bool is_mappable(const LaserScan& scan, const ScanConfig& config);
/// "none of the 12 scans has 20 returns (scan.min_points) between 0.1 m (scan.min_range) and 40 m (scan.max_range)".
std::string nothing_mappable(std::uint64_t scans, const ScanConfig& config);

/// Asks whether stamps are in seconds; empty if there is no doubt.
std::string question_of_unit(double usual_step_s);

/// The same question for a log that was mapped.
std::string question_of_unit(const Trajectory& trajectory);

struct LogCheck {
  std::uint64_t scans = 0;
  std::uint64_t scans_with_odometry = 0;
  std::uint64_t odometry_records = 0;
  NodCheck nod;
  double first_stamp_s = 0.0;  ///< earliest
  double last_stamp_s = 0.0;   ///< latest
  double median_step_s = 0.0;  ///< between scans of a laser, forward steps only; at most 10 s
  double usual_step_s = 0.0;   ///< the same; if it is longer, the mean of the steps of 10 s and more
  EventList gaps;              ///< time without a scan of any laser
  EventList backward_stamps;   ///< between scans of one laser, or by a second and more after any scan
  EventList repeated_stamps;   ///< from scan to scan of a laser
  EventList impossible_steps;  ///< jumps of the odometry
  double gap_bound_s = 0.0;
  double path_m = 0.0;            ///< by odometry, impossible steps left out
  double turned_rad = 0.0;        ///< sum of the absolute turns, impossible steps left out
  std::uint64_t still_scans = 0;  ///< scans with the same odometry as the laser's previous scan
  std::vector<BeamLayout> layouts;
  std::uint64_t other_layouts = 0;  ///< scans of layouts beyond the listed ones
  RangeStatistics ranges;
  NoReturns no_returns;
  std::vector<LaserMount> lasers;  ///< in the order of their first scans
  std::uint64_t scans_without_returns = 0;
  std::uint64_t mappable_scans = 0;  ///< with at least scan.min_points returns, as the mapper counts them
  ScanConfig scan;                   ///< the rule for counting them
  std::vector<std::string> questions_of_units;
  std::vector<LogReader::Warning> warnings;

  [[nodiscard]] double duration_s() const { return last_stamp_s - first_stamp_s; }
  /// Why the log cannot be mapped at all; empty when it can.
  [[nodiscard]] std::string obstacle() const;
  /// Advice for the user, a sentence each.
  [[nodiscard]] std::vector<std::string> suggestions() const;
};

/// Collects a LogCheck record by record.
class LogChecker {
 public:
  /// `scan` decides which scans the mapper can use.
  explicit LogChecker(const StepBounds& bounds, const ScanConfig& scan = {}) : bounds_(bounds) { check_.scan = scan; }
  void add(const LogRecord& record);
  /// The result; the warnings are the reader's.
  [[nodiscard]] LogCheck finish(const std::vector<LogReader::Warning>& warnings) const;

 private:
  void add_scan(const ScanRecord& record);
  /// Facts of a scan that the next scan of the same laser is compared with.
  struct LastScan {
    std::optional<double> stamp_s;
    std::optional<Pose2> T_odom_base;
  };
  std::size_t find_laser(const ScanRecord& record);
  void add_time(double stamp_s, std::optional<double>& before_s);
  void add_step(LogEvent event, double step_s);
  void add_pause(LogEvent event, double pause_s);
  void add_odometry(double stamp_s, const Pose2& T_odom_base, std::optional<Pose2>& before);
  void add_ranges(const ScanRecord& record);
  void add_layout(const LaserScan& scan, std::size_t laser);
  static void add_mount(const Pose2& T_base_laser, LaserMount& mount);
  void finish_times(LogCheck& check) const;
  void finish_ranges(LogCheck& check) const;

  StepBounds bounds_;
  LogCheck check_;
  NodChecker nod_;
  UnitCheck units_;
  std::vector<LastScan> last_scans_;          ///< for each of check_.lasers
  std::optional<StampedPose> last_odometry_;  ///< from either source
  std::optional<Pose2> last_record_;          ///< from the odometry's own records
  std::optional<double> last_scan_s_;         ///< for any laser
  std::vector<std::uint64_t> steps_ms_;       ///< histogram of the forward steps of each laser, the last bin open
  std::vector<std::uint64_t> pauses_ms_;      ///< histogram of the steps from scan to scan of any laser
  double long_steps_s_ = 0.0;                 ///< sum of the steps in the open bin
  std::vector<LogEvent> longest_pauses_;      ///< the longest first
  NoReturnFinder no_return_;
};

}  // namespace gdtslam
