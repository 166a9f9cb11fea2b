// Maps whole logs: feeds every scan to a Mapper, keeps the trajectory, the evidence against doubtful scans and the
// occupancy map. Used by the commands map and ablation. One run belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "scan_stream.hpp"

namespace gdtslam {

class Stopwatch;

/// What to map, and how.
struct MapJob {
  std::vector<std::string> logs;
  ReadOptions read;
  ScanRange range;
  MapperConfig mapper;
  OccupancyConfig occupancy;
  bool with_occupancy = true;
  bool with_pictures = true;  ///< overview.png
  MapperOptions on_failure;   ///< of the device
};

/// A scan whose match is in doubt.
struct DoubtfulScan {
  std::uint64_t index = 0;  ///< in the trajectory, from 0
  double stamp_s = 0.0;
  Doubt reason = Doubt::kNone;
  bool accepted = false;             ///< the match is taken all the same, not the prediction
  double from_prediction_m = 0.0;    ///< of the estimate
  double from_prediction_rad = 0.0;  ///< likewise, absolute
};

struct MapOutcome {
  Trajectory trajectory;
  std::vector<DoubtfulScan> doubtful;
  std::vector<std::size_t> keyframes;  ///< indices into the trajectory
  /// Of each match that was taken: the mean distance of its points to the obstacles of the map as it was then.
  std::vector<double> match_distances_m;
  OccupancyMap occupancy;
  MapperStatistics statistics;
  std::vector<LogReader::Warning> warnings;
  std::string device_loss;      ///< the error of the device that failed; empty when none did
  double log_duration_s = 0.0;  ///< between the earliest and the latest stamp
  double wall_s = 0.0;          ///< of the whole run, reading included
  double cpu_s = 0.0;           ///< of the process during the run
  double read_s = 0.0;
  double mapper_s = 0.0;      ///< inside the mapper
  double mapper_cpu_s = 0.0;  ///< likewise, CPU time of all threads
  double occupancy_s = 0.0;
  bool interrupted = false;
};

/// Scans that got a pose, matched or not.
inline std::uint64_t scans_of(const MapOutcome& outcome) { return outcome.trajectory.size(); }
/// Adds a matched scan to the trajectory, the keyframes, the doubtful scans and the matches.
/// Its pose is the one given, which may be better than the match.
void note_match(const MatchResult& result, const Pose2& T_map_base, MapOutcome& outcome);
/// Without one merged scan there is no map to write: throws InputError that says why.
void require_a_map(const MapJob& job, const MapOutcome& outcome, std::uint64_t scans_read);
OccupancyBuilder::Limits occupancy_limits(const MapperConfig& config);

class MapRun {
 public:
  /// Opens the first log and prepares the mapper. Throws ConfigError, InputError or FileError.
  MapRun(const MapJob& job, Backend& backend);
  /// With the logs open already.
  MapRun(const MapJob& job, Backend& backend, ScanStream scans);

  /// Called after each scan with the number of scans and the share done (negative when unknown).
  using Progress = std::function<void(std::uint64_t, double)>;
  /// Runs to the end, or until stop() is true. Throws InputError when the logs
  /// hold no scan that can be mapped.
  MapOutcome run(const Progress& progress, const std::function<bool()>& stop);

  [[nodiscard]] const Mapper& mapper() const { return mapper_; }

 private:
  /// The scan after the one in hand: read, or not to be had, or not to be read.
  struct NextScan {
    std::optional<ScanRecord> scan;
    std::exception_ptr problem;
  };

  std::optional<ScanRecord> next_scan(const std::function<bool()>& stop);
  MatchResult map_scan(const ScanRecord& scan, NextScan& next, const std::function<bool()>& stop, Stopwatch& watch,
                       MapOutcome& outcome);

  MapJob job_;
  ScanStream scans_;
  Mapper mapper_;
  OccupancyBuilder occupancy_;
};

}  // namespace gdtslam
