// Maps logs to a run folder. Other programs get the same bytes as from `gdtslam map`. 2D, and 3D if a log has messages
// of its nodding mount. One call belongs to one thread; the backend may use more. docs/howto/live.md has an example.
#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/runs/outcome.hpp"
#include "gdtslam/runs/settings.hpp"

namespace gdtslam {

/// Draws the cloud of a run as the bytes of a PNG file: cloud file, first log, robot poses, linkage (null: the laser
/// has none). Throws UnavailableError if nothing can draw.
using CloudPicture = std::function<std::string(const std::string& cloud_file, const std::string& log,
                                               const Trajectory& trajectory, const calib::SweepModel* linkage)>;

using ClosedKeyframesSoon = std::shared_future<ClosedKeyframes>;

/// A mapped scan, for code that follows a running drive.
struct MappedScan {
  const LaserScan& scan;
  const MatchResult& match;  ///< in the front end's frame, at the scan's stamp
  /// Pose of the front end's frame in the one with the loops so far closed (LoopClosing::correction()).
  Pose2 T_closed_front;
  /// New keyframes if this scan changed that pose (LoopClosing::request_keyframes()); else no valid future.
  ClosedKeyframesSoon closed_keyframes;
  /// False if the scan was matched together with the next one, as one observation of several lasers.
  bool ends_observation = true;
};
using ScanMapped = std::function<void(const MappedScan&)>;

/// Opens a log other than by its name, in the calling thread.
using LiveLog = std::function<std::unique_ptr<LogReader>(const ReadOptions&)>;

/// Warning about a log that ended with this code, if that is no error (MapRequest::stop_ends_log). Either the log ends
/// with unreadable data, or it is whole but lacks what the warning names.
constexpr std::string_view warning_of_end(ExitCode code) {
  return code == ExitCode::kUsage ? "not in the log" : "the log broke off";
}

/// The logs to map, the options, and the folder of the results.
struct MapRequest {
  std::vector<std::string> logs{};  ///< mapped in order as one log; "-" is the standard input
  std::string folder{};             ///< folder of the results; made if need be
  Settings settings{};              ///< every option of the configuration
  bool lenient = false;             ///< count and skip malformed lines instead of throwing
  ScanRange range{};
  std::string linkage{};  ///< preset or file for a nodding laser; empty: the first log's sidecar file, else the default
  /// Folder of a run to continue: its configuration, range, linkage and parts replace those here, its logs are read
  /// again, and `logs` follow them. Empty: a new run.
  std::string continued{};
  bool with_continue_file = true;  ///< writes continue.json and the data of streams, so that the run can be continued
  bool replace_foreign_files = false;  ///< foreign files in the folder are removed; otherwise the folder is refused
  bool with_cloud = true;
  bool with_map = true;        ///< the occupancy map and its pictures, overview and graph
  bool with_loops = true;      ///< loops are closed once the log has ended
  bool with_pictures = true;   ///< overview and graph (PNG, or SVG if nothing makes pixels), cloud.png
  CloudPicture draw_cloud{};   ///< cloud.png; empty: none
  MapperOptions on_failure{};  ///< reaction to a failing device

  std::function<void(std::uint64_t scans, double share)> progress{};  ///< after each scan; share negative when unknown
  std::function<void(std::string_view step, double share)>
      closing{};  ///< called while loops are closed and the path is adjusted
  std::function<void(std::string_view what)>
      finishing{};               ///< called before each later step: "overview.png", "gdt.png" ...
  std::function<bool()> stop{};  ///< returning true ends the run; the results so far are written
  /// If true, a stop or unreadable data after the first scan counts as the end of the log: loops are closed, and the
  /// run is complete. Otherwise the path keeps the mapper's poses.
  bool stop_ends_log = false;
  /// For live mapping: called as soon as a scan is mapped, before the next one is read. The laser is assumed not to
  /// nod, and nothing is read ahead to check that.
  ScanMapped scan_mapped{};
  /// Opens a stream that is mapped instead of the only log; messages use the log's name. Called once.
  LiveLog live_log{};
  std::function<void(const std::string&)> warn{};  ///< called with one line at a time, before the work begins
};

/// Result of a run.
struct MapResult {
  MapOutcome outcome;
  std::string linkage;  ///< preset or file that was used for a nodding laser
  std::string report;   ///< the text of report.json
};

/// Returns the backend of a run, once its log is open. `has_work` is false if the CPU is faster than any device: at the
/// scans of a flat laser, one after the other, unless each has a window. The backend must live as long as the run.
using BackendOfRun = std::function<Backend&(bool has_work)>;

/// Maps the logs and writes the run folder, all files or none. Throws InputError, ConfigError, FileError,
/// UnavailableError, what `backend` throws, DeviceError if the request does not allow the run to go on without the
/// device, UsageError if the run cannot be continued in that way, and Error(kInterrupted) if it is stopped before a
/// scan was mapped.
MapResult map_logs(const MapRequest& request, const BackendOfRun& backend);
inline MapResult map_logs(const MapRequest& request, Backend& backend) {
  return map_logs(request, [&backend](bool) -> Backend& { return backend; });
}

}  // namespace gdtslam
