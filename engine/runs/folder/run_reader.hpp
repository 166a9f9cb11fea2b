// Reads back the folder that a run of `gdtslam map` wrote. Each file is checked when it is asked for, against what
// report.json says of it (RunFiles), and every message names the file and what to do. One reader belongs to one thread.
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
  double path_m = 0.0;  ///< length as the mapper counted it; pictures show the length of the path they draw
  std::uint64_t cloud_points = 0;
  std::optional<GridGeometry> map;              ///< geometry of map.pgm; none if it was left out
  std::uint64_t tiles = 0;                      ///< in place of gdt.png and of all cells in map.pgm; 0: in one piece
  std::string map_sha256;                       ///< hash of the distance field
  std::optional<std::string> keyframes_sha256;  ///< none if the laser nods or the report is of an older version
  bool nods = false;
  bool has_loops = false;              ///< closed ones, perhaps none of them found: doubts() tells of them
  bool tilts = false;                  ///< nods without a linkage: the log told the elevation itself
  std::vector<std::size_t> doubtful;   ///< indices into the trajectory
  std::vector<std::size_t> keyframes;  ///< indices too; empty if the report is of an older version
  std::vector<std::size_t> drives;     ///< indices at which another drive begins
};

class RunReader {
 public:
  /// Throws InputError where the folder is no finished run, or its report cannot be used; FileError.
  explicit RunReader(std::string folder);

  [[nodiscard]] const RunSummary& summary() const { return summary_; }
  [[nodiscard]] const std::string& folder() const { return files_.folder(); }
  /// For what is read elsewhere.
  [[nodiscard]] const RunFiles& files() const { return files_; }
  /// The first log's name without folder and endings: "office-7f".
  [[nodiscard]] std::string name() const;
  /// Throws InputError or FileError, like the other members.
  [[nodiscard]] Trajectory trajectory() const;
  [[nodiscard]] bool has_trajectory() const;
  /// How sure each pose of the trajectory is; nothing where the run closed no loops or is of an older version. Throws
  /// InputError too where poses and covariances are not of one run.
  [[nodiscard]] std::optional<std::vector<PoseCovariance>> covariances() const;
  /// Its places and relations; throws where the run closed no loops.
  [[nodiscard]] GraphLines graph() const;
  /// Doubts that the report has about the map; reads it again.
  [[nodiscard]] RunDoubts doubts() const;
  /// For a run in tiles the small map of all of them. Also throws InputError if the run was asked to make none.
  [[nodiscard]] OccupancyMap map() const;
  /// Throws InputError too where the run is in tiles.
  [[nodiscard]] DistanceFieldFile field() const;
  /// The configuration that it was mapped with. Throws ConfigError too.
  [[nodiscard]] Settings settings() const;
  /// The keyframes that the map was merged from; none if the run has no such file. Also throws InputError if their
  /// scans are others than those of the report.
  [[nodiscard]] std::optional<RunKeyframes> keyframes() const;
  /// The file of the 3D cloud; nothing where the run made none. Whoever has read it asks files() whether it is
  /// unchanged. Throws InputError where it is missing or another one.
  [[nodiscard]] std::optional<std::string> cloud_file() const;
  /// How the laser nods; nothing where the run did not need it or is of an older version. Where the laser tilts only
  /// the mount counts. Throws ConfigError too.
  [[nodiscard]] std::optional<calib::SweepModel> linkage() const;

  /// True for a folder that holds a report.
  static bool is_run(const std::string& path);
  /// Whether in the folder lies what a run leaves there and no report: it is just being replaced, or who did so was
  /// killed.
  static bool is_broken_run(const std::string& path);
  /// True where that report is one of `gdtslam map`, of whatever version. Throws FileError.
  static bool is_gdtslam_run(const std::string& path);

 private:
  [[noreturn]] void refuse(const char* name, const std::string& fault) const;

  RunSummary summary_;
  RunFiles files_;  // whose constructor gives the summary
};

// The graph of a run that closed loops, put together from graph.g2o and report.json. Frame: map. Thread-safe; linear in
// places and relations.

struct RunGraph {
  /// The places' poses as the graph came to, what was measured along the path, by the front end before the wheels, and
  /// the loops with what each was worth by itself and its weight; indices are places.
  PoseGraph graph;
  std::vector<std::size_t> scans;  ///< for each place, ascending: an index into the trajectory
  std::vector<bool> is_on;         ///< for each loop, as the report has it
};

/// Throws InputError where the run has no graph, is a site of several drives, or its graph is not of one run with its
/// report: other scans, a step of the path that is missing, other loops; FileError.
RunGraph read_run_graph(const RunReader& run);

// Trajectories and clouds that a command was given: the file itself, or the folder of the run that wrote it, whose
// report is checked as RunReader does. Another program's folder will do if it has a file of that name. Thread-safe.

/// Throws InputError where the folder has what is left of a run without its report (RunReader::is_broken_run): the file
/// `name` of it would be of nobody knows which run. The same where it holds the sites of a merge.
void refuse_broken_run(const std::string& folder, const char* name);

/// The poses of a TUM file, or of trajectory.tum in a folder. Throws FileError, and InputError that says what to give.
Trajectory given_trajectory(const std::string& given);

/// The file of a cloud: `given` unless that is a folder, then its cloud.ply. Nothing is said of the file itself, which
/// its reader checks. Throws InputError where the folder has none, with the reason that its run gives; FileError.
std::string given_cloud(const std::string& given);
/// The same, and the run that the cloud is of, for whoever has read it to ask its files() whether they are unchanged;
/// nothing where it is of none.
std::string given_cloud(const std::string& given, std::optional<RunReader>& run);

}  // namespace gdtslam
