// Parts of `gdtslam calibrate`. run.cpp finds a linkage from the log of a standing robot among surfaces of known kinds.
// self_run.cpp (--self) maps the logs with the start's linkage and makes the laser's strokes agree. stops.cpp averages
// ranges; then text, JSON and figure. One run belongs to one thread.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "calib/calibration/self_calibration.hpp"
#include "gdtslam/calib/calibration.hpp"
#include "gdtslam/calib/nod_track.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {

// Observations: each selected beam gets the crank's position at its time; ranges of one beam at one position are
// averaged. Memory: one entry per position and beam.

struct StopStatistics {
  std::uint64_t scans = 0;
  std::uint64_t uncovered = 0;  ///< scans at a time without a known crank position
  std::uint64_t ranges = 0;     ///< returns of the selected beams
  std::uint64_t stops = 0;      ///< crank positions with a range
  double range_sigma_m = 0.0;   ///< sigma of one range, from the scatter at a position
};

/// The crank's position, in turns, at a time between the knots; empty for fewer than two knots.
std::optional<double> turns_at(const std::vector<PhaseKnot>& knots, double offset_s);

class StopCollector {
 public:
  /// Selects beams within half the sector of the forward direction, at least the forward one; a large sector is
  /// thinned.
  StopCollector(const calib::SweepModel& model, double sector_rad);
  void take(const LogRecord& record);
  /// Call it at the end of each log: places waiting scans with the known crank positions. The next log has its own
  /// clock and odometry. Returns faults of the crank's messages. Throws InputError if the robot moved, or if an encoder
  /// without an index mark jumped, because the crank's position is unknown afterwards.
  std::vector<LogReader::Warning> finish_log(const std::string& name);
  /// Averages, without those of few ranges. `sigma_m` of one range; 0: from the scatter. Throws InputError if the log
  /// has no crank, no scan, or no scan at a time with a known crank position.
  [[nodiscard]] std::vector<calib::RangeObservation> observations(double sigma_m);
  [[nodiscard]] const StopStatistics& statistics() const { return statistics_; }

 private:
  /// Sums over the ranges of one beam at one position.
  struct Sums {
    std::uint32_t scans = 0;
    std::uint32_t count = 0;
    double first_ticks = 0.0;
    double first_range_m = 0.0;
    double ticks = 0.0;  ///< less first_ticks, and the range less first_range_m: keeps the digits of the squares
    double range_m = 0.0;
    double sq_ticks = 0.0;
    double sq_range = 0.0;
    double product = 0.0;
  };
  /// Largest distance of the robot from its first odometry pose.
  struct Travel {
    double metres = 0.0;
    double angle_rad = 0.0;
  };
  void note_odometry(const Pose2& T_odom_base);
  void note_beams(const LaserScan& scan);
  void require_standing(const std::string& name) const;
  void require_counting(const std::string& name) const;
  void place_scans(bool at_end);
  void add(const LaserScan& scan);
  [[nodiscard]] std::size_t beam_step(const LaserScan& scan) const;
  void add_range(std::pair<std::uint32_t, std::uint32_t> key, double ticks, double range_m, bool is_return);
  [[nodiscard]] double scatter_m() const;

  calib::SweepModel model_;
  double half_sector_rad_;
  calib::NodTrack track_;
  std::deque<LaserScan> waiting_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Sums> sums_;  ///< by position and beam
  double bearing_first_rad_ = 0.0;
  double bearing_step_rad_ = 0.0;  ///< 0 before the first scan
  std::optional<Pose2> T_odom_first_;
  Travel travel_;
  LogReader::Warning uncovered_{
      .kind = "scans without the crank's position", .count = 0, .first = ""};  ///< in this log
  calib::NodTrack::Count gaps_;  ///< between the encoder's messages, in finished logs
  std::uint64_t encoder_messages_ = 0;
  std::uint64_t tilt_messages_ = 0;
  StopStatistics statistics_;
};

struct CalibrateJob {
  std::vector<std::string> logs;
  calib::SweepModel start;
  std::string surfaces = "wall";  ///< text of the option: "wall=2m@30deg,ceiling"
  bool distances_known = false;
  bool headings_free = false;
  double sector_rad = 0.0;  ///< 0: the forward beam
  double sigma_m = 0.0;     ///< sigma of one range; 0: from the scatter
  ReadOptions read;
  calib::CalibrationOptions options;
};

struct CalibrateOutcome {
  calib::SweepModel start;
  std::vector<calib::CalibrationSurface> start_surfaces;
  calib::CalibrationResult result;
  std::vector<calib::RangeObservation> observations;  ///< with their surfaces, all elevations
  double max_elevation_rad = 0.0;
  std::size_t unassigned = 0;  ///< averages without a surface
  StopStatistics statistics;
  std::vector<LogReader::Warning> warnings;  ///< from the readers and the encoder
  std::string distrust;                      ///< reason not to use the result; empty: none
};

/// Throws UsageError for impossible surfaces before reading a log; InputError, FileError or ConfigError.
CalibrateOutcome run_calibration(const CalibrateJob& job, const std::function<void(double)>& progress,
                                 const std::function<bool()>& stop);

/// Figure A of the paper: measured and modelled ranges over the encoder, and residuals over the elevation, before and
/// after.
Canvas calibration_figure(const CalibrateOutcome& outcome);

struct SelfCalibrateJob {
  std::vector<std::string> logs;
  calib::SweepModel start;
  ReadOptions read;
  calib::SelfCalibrationOptions options;
};

struct SelfCalibrateOutcome {
  calib::SweepModel start;
  calib::SelfCalibrationResult result;
  std::uint64_t scans = 0;
  std::uint64_t beams = 0;  ///< beams compared, an even sample of all
  std::uint32_t strokes = 0;
  std::vector<LogReader::Warning> warnings;  ///< from the readers and the encoder
  std::string distrust;                      ///< reason not to use the result; empty: none
};

/// Throws InputError, FileError, ConfigError.
SelfCalibrateOutcome run_self_calibration(const SelfCalibrateJob& job, const std::function<void(double)>& progress,
                                          const std::function<bool()>& stop);

std::string as_text(const CalibrateOutcome& outcome);
std::string as_text(const SelfCalibrateOutcome& outcome);
nlohmann::ordered_json as_json(const CalibrateOutcome& outcome);
nlohmann::ordered_json as_json(const SelfCalibrateOutcome& outcome);

}  // namespace gdtslam
