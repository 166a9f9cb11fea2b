// Reads back the folder that a run of `gdtslam map` wrote. Each file is compared with report.json when it is read
// (RunFiles), and every message names the file and what to do. One reader belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/runs/folder/loop_files.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_review.hpp"
#include "engine/runs/keyframes/run_keyframes.hpp"
#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/map_files.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/runs/settings.hpp"

namespace gdtslam {

/// The part of report.json that a picture needs.
struct RunSummary {
  std::vector<std::string> logs;
  std::uint64_t scans = 0;
  std::uint64_t matched = 0;
  std::uint64_t keyframe_count = 0;
  double path_m = 0.0;  ///< length by the mapper; pictures show the length of the drawn path
  std::uint64_t cloud_points = 0;
  std::optional<GridGeometry> map;  ///< geometry of map.pgm; none if it was left out
  std::uint64_t tiles = 0;          ///< number of tiles, if they replace gdt.png and the cells of map.pgm; 0: one piece
  std::string map_sha256;           ///< hash of the distance field
  std::optional<std::string> keyframes_sha256;  ///< none if the laser nods or the report is of an older version
  bool nods = false;
  bool has_loops = false;              ///< loops were closed, perhaps none found: see doubts()
  bool tilts = false;                  ///< nods without a linkage: the log has the elevation itself
  std::vector<std::size_t> doubtful;   ///< indices into the trajectory
  std::vector<std::size_t> keyframes;  ///< indices; empty if the report is of an older version
  std::vector<std::size_t> drives;     ///< indices of the first scans of further drives
};

class RunReader {
 public:
  /// Throws InputError if the folder is no finished run, or its report cannot be used; FileError.
  explicit RunReader(std::string folder);

  [[nodiscard]] const RunSummary& summary() const { return summary_; }
  [[nodiscard]] const std::string& folder() const { return files_.folder(); }
  /// The checked files, for other readers.
  [[nodiscard]] const RunFiles& files() const { return files_; }
  /// The first log's name without folder and endings: "office-7f".
  [[nodiscard]] std::string name() const;
  /// Throws InputError or FileError, like the other members.
  [[nodiscard]] Trajectory trajectory() const;
  [[nodiscard]] bool has_trajectory() const;
  /// The covariance of each pose of the trajectory; none if the run closed no loops or is of an older version. Also
  /// throws InputError if poses and covariances are not of one run.
  [[nodiscard]] std::optional<std::vector<PoseCovariance>> covariances() const;
  /// Places and relations of the run's graph; throws if the run closed no loops.
  [[nodiscard]] GraphLines graph() const;
  /// The report's doubts about the map; reads it again.
  [[nodiscard]] RunDoubts doubts() const;
  /// The occupancy map; for a run in tiles the small map of all tiles. Also throws InputError if the run made no map.
  [[nodiscard]] OccupancyMap map() const;
  /// Also throws InputError if the run is in tiles.
  [[nodiscard]] DistanceFieldFile field() const;
  /// The configuration of the run. Also throws ConfigError.
  [[nodiscard]] Settings settings() const;
  /// The keyframes that the map was merged from; none if the run has no such file. Also throws InputError if the report
  /// has other scans.
  [[nodiscard]] std::optional<RunKeyframes> keyframes() const;
  /// The file of the 3D cloud; none if the run made none. After reading it, call files().expect_unchanged(). Throws
  /// InputError if the file is missing or was changed.
  [[nodiscard]] std::optional<std::string> cloud_file() const;
  /// Linkage of a nodding laser; none if the run did not need it or is of an older version. If the log has the
  /// elevation, only the mount counts. Also throws ConfigError.
  [[nodiscard]] std::optional<calib::SweepModel> linkage() const;

  /// True for a folder that holds a report.
  static bool is_run(const std::string& path);
  /// True for a folder with files of a run but no report: the run is being replaced, or the process doing so was
  /// killed.
  static bool is_broken_run(const std::string& path);
  /// True for a report of `gdtslam map` of any version. Throws FileError.
  static bool is_gdtslam_run(const std::string& path);

 private:
  [[noreturn]] void refuse(const char* name, const std::string& fault) const;

  RunSummary summary_;
  RunFiles files_;  // its constructor fills the summary
};

// The graph of a run that closed loops, from graph.g2o and report.json. Frame: map. Thread-safe; linear in places and
// relations.

struct RunGraph {
  /// The optimised poses of the places, the measured steps of the path (the front end's before the wheels'), and the
  /// loops with the information and the weight of each; indices are places.
  PoseGraph graph;
  std::vector<std::size_t> scans;  ///< index into the trajectory for each place, ascending
  std::vector<bool> is_on;         ///< for each loop, by the report
};

/// Throws InputError if the run has no graph, is a site of several drives, or its graph does not match its report:
/// other scans, a missing step of the path, other loops. Throws FileError.
RunGraph read_run_graph(const RunReader& run);

// Trajectories and clouds given to a command: the file itself, or a run's folder, which is checked as by RunReader.
// Another program's folder is accepted if it has a file of that name. Thread-safe.

/// Throws InputError if the folder has files of a run without its report (RunReader::is_broken_run), because the run of
/// its file `name` is unknown. Also if it holds the sites of a merge.
void refuse_broken_run(const std::string& folder, const char* name);

/// The poses of a TUM file, or of trajectory.tum in a folder. Throws FileError, and InputError that says what to give.
Trajectory given_trajectory(const std::string& given);

/// The file of a cloud: `given`, or cloud.ply in it if that is a folder. A file itself is left to its reader to check.
/// Throws InputError with the reason if the folder has no cloud; FileError.
std::string given_cloud(const std::string& given);
/// Also gives the cloud's run, if it has one, so that the caller can check after reading that its files() are
/// unchanged.
std::string given_cloud(const std::string& given, std::optional<RunReader>& run);

}  // namespace gdtslam
