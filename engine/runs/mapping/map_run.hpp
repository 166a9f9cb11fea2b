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

#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/runs/outcome.hpp"

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
  bool with_pictures = true;  ///< the overview of the map
  MapperOptions on_failure;   ///< of the device
};

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
