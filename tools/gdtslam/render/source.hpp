// Inputs of `gdtslam render`: each one's kind, recognised by content, and its data, read once when a view needs them.
// One source belongs to one thread.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "engine/runs/folder/run_pictures.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/image.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {

enum class RenderKind : std::uint8_t { kRun, kCloud, kLinkage, kMap, kField, kTrajectory };
/// "a run", "a cloud", ...
std::string_view to_string(RenderKind kind);
/// Detects the kind by the path and the first bytes, decompressed; a preset's name is a linkage. Throws FileError for a
/// missing file (with the nearest preset), InputError for other content, logs included.
RenderKind kind_of_input(const std::string& input);

/// Data that views need, as bits of a set.
namespace part {
inline constexpr unsigned kMap = 1U;
inline constexpr unsigned kField = 2U;
inline constexpr unsigned kTrajectory = 4U;
inline constexpr unsigned kCloud = 8U;
inline constexpr unsigned kLinkage = 16U;
inline constexpr unsigned kTruth = 32U;      ///< --reference or --relations of a trajectory
inline constexpr unsigned kMount = 64U;      ///< the mount of a linkage or of a laser that tilts by itself
inline constexpr unsigned kGraph = 128U;     ///< the graph of a run that closed loops
inline constexpr unsigned kTruePath = 256U;  ///< --reference of a trajectory, itself one
inline constexpr unsigned kReplay =
    512U;  ///< the graph of a run that closed loops in one drive, so not of a merged site
}  // namespace part

/// Options for reading a cloud.
struct CloudReading {
  std::uint64_t most = 0;                                 ///< points; more are thinned (PointLimit); 0: no limit
  std::function<bool(const CloudPoint&)> is_wanted{};     ///< empty: all are
  std::function<void(std::uint64_t, double)> progress{};  ///< points read and their share; below 0: unknown
  std::function<void(const std::string&)> remark{};       ///< receives a line about skipped points
};
struct PointsOfCloud {
  Cloud cloud;
  std::uint64_t points = 0;  ///< before thinning
};

class RenderSource {
 public:
  /// Throws like kind_of_input() and RunReader.
  explicit RenderSource(std::string input);

  [[nodiscard]] RenderKind kind() const { return kind_; }
  [[nodiscard]] const std::string& input() const { return input_; }
  /// Name for titles and files: "office-7f".
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] unsigned parts() const { return parts_; }
  /// Sets another linkage: a preset's name or a file.
  void set_linkage(const std::string& linkage);
  /// Null if the input is not a run.
  [[nodiscard]] const RunReader* run() const { return run_ ? &*run_ : nullptr; }

  // Each throws InputError, FileError or ConfigError if its file cannot be used.
  const OccupancyMap& map();
  const FieldPicture& field();
  /// Beside a cloud without a run, relative to the origin taken off its points (origin_of_cloud), like cloud().
  const Trajectory& trajectory();
  /// The model of the mount; an input with kMount alone has a valid mount only.
  const calib::SweepModel& linkage();
  /// Reads the cloud at each call, because a scene keeps the points that it draws.
  [[nodiscard]] PointsOfCloud cloud(const CloudReading& reading) const;
  /// The cloud's file; a run's file is checked against its report.
  [[nodiscard]] std::string cloud_file() const;
  /// Throws UsageError if a cloud without a run has no values for this colour.
  void require_values(CloudColour colour) const;
  /// Path, keyframes and doubtful scans; empty if there is no trajectory.
  PathOverlay overlay();
  /// The graph of an input with kGraph: loops, covariances, doubtful stretches, and a line with their numbers.
  struct Graph {
    GraphOverlay overlay;
    std::string subtitle;
  };
  Graph graph();

 private:
  void open_cloud();
  [[nodiscard]] Trajectory read_trajectory() const;

  std::string input_;
  std::string name_;
  RenderKind kind_;
  unsigned parts_ = 0;
  std::string cloud_file_;
  std::string trajectory_file_;
  std::optional<RunReader> run_;
  std::optional<OccupancyMap> map_;
  std::optional<FieldPicture> field_;
  std::optional<Trajectory> trajectory_;
  std::optional<calib::SweepModel> linkage_;
};

/// Reads a cloud from a file. Points that are not finite or farther than 1000 km from the origin are skipped, and
/// `remark` receives their number; single precision is coarser than 6 cm there. Throws InputError or FileError, also if
/// no points are left.
PointsOfCloud read_cloud(const std::string& path, const CloudReading& reading);
/// The origin taken off the points of that cloud on reading (CloudReader::make_relative).
std::array<double, 3> origin_of_cloud(const std::string& path);
/// The last name of a file's or folder's path, whatever the form of the path.
std::string name_of_place(const std::string& path);

}  // namespace gdtslam
