// Closes loops while a mapper maps. A second thread finds the loops. Once the log has ended, the back end adjusts all
// keyframes together, then every scan (docs/loops.md). There are two frames. Poses in the mapper's frame are right
// relative to the poses shortly before and never leap. In the closed frame, a place that is seen again keeps its
// position.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

struct BatchDevice;
struct MapperOptions;

/// How well a relative pose is known: the inverse of the covariance of (x, y, theta), the motion along the axes of the
/// measured pose that would make it the true one.
struct PoseInformation {
  double xx = 0.0;  ///< 1/m^2
  double xy = 0.0;
  double xt = 0.0;  ///< 1/(m rad)
  double yy = 0.0;
  double yt = 0.0;
  double tt = 0.0;  ///< 1/rad^2
};

/// A loop: the robot came back to an earlier place.
struct ClosedLoop {
  std::size_t from = 0;  ///< numbers of the scans
  std::size_t to = 0;
  Pose2 T_from_to;  ///< measured relative pose
  PoseInformation information;
  double weight = 0.0;  ///< factor on its information, from 0 (switched off) to 1
  double off_m = 0.0;   ///< distance of the measured pose from the one in the graph
  double off_rad = 0.0;
  bool is_on = false;
};

/// A place of the path: a node of the graph in which loops are closed.
struct GraphPlace {
  std::size_t scan = 0;  ///< its number
  Pose2 T_map_base;      ///< pose in the graph, before the joint adjustment of all keyframes
};

/// The relation measured between two consecutive places.
struct PathRelation {
  std::size_t from = 0;  ///< numbers of the scans
  std::size_t to = 0;
  Pose2 T_from_to;
  PoseInformation information;  ///< information of the source after the loops are closed
  bool is_by_wheels = false;    ///< else by the mapper, which also uses the wheels
};

/// Systematic errors of the wheels, with a standard deviation each, and the weight that the wheels got.
struct WheelReport {
  double distance = 0.0;        ///< share that is missing in distances
  double turn = 0.0;            ///< share that is missing in turns
  double turn_rad_per_m = 0.0;  ///< turn that is missing in each metre forward
  double sigma_distance = 0.0;
  double sigma_turn = 0.0;
  double sigma_rad_per_m = 0.0;
  double variance_factor = 1.0;             ///< factor that loops find for the stated variance of the wheels' steps
  double variance_factor_of_matches = 1.0;  ///< the same for the mapper's own poses
};

/// Result of closing the loops.
struct ClosedPath {
  bool is_closed = false;                   ///< false if it was stopped: then the poses are the mapper's
  std::vector<Pose2> T_map_base;            ///< one a scan
  std::vector<PoseCovariance> covariances;  ///< covariance of each pose; empty if the run was stopped
  WheelReport wheels;
  std::vector<std::size_t> keyframes;  ///< numbers of the scans
  std::vector<ClosedLoop> loops;
  std::vector<GraphPlace> places;  ///< in the order of the path, the first at the origin; empty if it was stopped
  std::vector<PathRelation> path;  ///< by the mapper, then by the wheels, each in the order of the path
  std::uint64_t searches = 0;
  std::uint64_t pruned = 0;  ///< keyframes made redundant by later passes of a place: adjusted like other scans
  std::uint64_t pairs = 0;   ///< pairs of keyframes matched with each other
  double rms_m = 0.0;        ///< RMS distance of their points from the lines of the other
};

/// Loops that took effect during mapping.
struct LiveStatistics {
  std::uint64_t places = 0;       ///< places reached
  std::uint64_t corrections = 0;  ///< changes of LoopClosing::correction()
  std::uint64_t waits = 0;        ///< scans that waited for the search for loops
  double waited_s = 0.0;          ///< total waiting time
  double beside_cpu_s = 0.0;      ///< CPU time of the second thread; 0 if there is none
};

/// The map at some keyframe. It never changes, can be used in any thread, and outlives the mapper.
struct FrozenMap {
  std::shared_ptr<const GlobalField> field;  ///< distance field; empty before the first keyframe
  std::size_t keyframes = 0;                 ///< number of keyframes in it
  Pose2 T_closed_front;                      ///< LoopClosing::correction() that belongs to it
};

/// The keyframes so far, with the loops found by then closed.
struct ClosedKeyframes {
  std::vector<Pose2> T_map_base;  ///< in their order
  Pose2 T_closed_front;           ///< carries later poses of the mapper into the same frame
};

struct KeptScan;

/// The part of a Mapper that closes loops: Mapper::loops().
class LoopClosing {
 public:
  /// Receives the current step and its finished share.
  using Progress = std::function<void(std::string_view, double)>;

  LoopClosing(const MapperConfig& config, const MapperOptions& options, const BatchDevice& device);
  ~LoopClosing();
  LoopClosing(const LoopClosing&) = delete;
  LoopClosing& operator=(const LoopClosing&) = delete;

  /// The configuration of a mapper whose loops are closed: it matches with a map of the last stretch of the path, and
  /// weighs odometry against matches.
  static MapperConfig adapt_config(MapperConfig config);

  /// Correction for controllers during mapping: T_closed_front * MatchResult::T_map_base is the pose with the loops
  /// found so far closed. It leaps when a loop takes effect; the mapper's poses do not. A loop found at a place takes
  /// effect eight places later, at a keyframe that the log alone determines: live and offline, with any number of
  /// threads, it has the same values at the same scans.
  [[nodiscard]] const Pose2& correction() const;
  /// Requests the distance field of the keyframes so far, in the closed frame with the loops found by then. Its content
  /// depends on the log alone; the time until it is ready depends on the machine. The thread that searches for loops
  /// makes it, in some 0.5 ms a keyframe, during which the search waits. The future holds exceptions: InputError if the
  /// map would exceed map.max_megacells, std::future_error (broken promise) if the mapper ended before. Do not call it
  /// after close().
  std::shared_future<FrozenMap> request_map();
  /// The poses of the keyframes so far, ready when the thread that searches for loops has reached them. The call itself
  /// takes almost no time. As with request_map(), the future is broken if the mapper ends first, and close() must not
  /// have been called.
  std::shared_future<ClosedKeyframes> request_keyframes();
  [[nodiscard]] LiveStatistics statistics() const;

  /// Call it once, after the last scan. If stop() is or becomes true, the path stays as the mapper measured it. With
  /// more than one thread (MapperOptions::cpu) the path is adjusted by all, and the field is still being made when this
  /// returns.
  ClosedPath close(const Progress& progress, const std::function<bool()>& stop);
  /// Waits until the field is made; returns the CPU seconds of a thread that made it after close().
  double finish_field() const;
  /// The distance field of all keyframes at their poses from close(). Throws InputError if the map would exceed
  /// map.max_megacells.
  [[nodiscard]] const GlobalField& field() const;

 private:
  friend class Mapper;
  /// Takes the mapper's next scan. Rethrows exceptions of the search for loops. Waits for the search if it is more than
  /// eight places, 32 m of path, behind.
  void take(const KeptScan& scan, const MatchResult& result);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
