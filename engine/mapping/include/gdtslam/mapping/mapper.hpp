// The 2D system of figure 5: one scan in, one pose out. Frames: the map's origin is the robot's pose at the first scan.
// One mapper belongs to one thread; its backend may use more. Cost: docs/benchmarks.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/match.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {

/// Seconds spent in each step of figure 5.
struct StageTimes {
  double predict_s = 0.0;
  double match_s = 0.0;  ///< gate, descent and search
  double local_field_s = 0.0;
  double merge_s = 0.0;
};

/// Counts over the run so far.
struct MapperStatistics {
  std::uint64_t scans = 0;
  std::uint64_t matched = 0;           ///< pose from the matcher
  std::uint64_t doubtful = 0;          ///< fell back to the prediction, or matched with weak evidence
  std::uint64_t keyframes = 0;         ///< merged into the map
  std::uint64_t searches = 0;          ///< scans for which a window was searched
  std::uint64_t attempts = 0;          ///< windows searched, all together
  std::uint64_t restarts = 0;          ///< keyframes merged where odometry says, after a long stretch without a match
  std::uint64_t odometry_leaps = 0;    ///< odometry steps too long to be true
  std::uint64_t without_odometry = 0;  ///< scans predicted from the last motion
  std::uint64_t evaluations = 0;
  std::uint64_t dispatches = 0;   ///< kernels run, by the backend at work; replays on the CPU are not counted
  std::uint64_t submissions = 0;  ///< of a device; a backend that works at once, as the CPU does, counts none
  double path_m = 0.0;
  StageTimes stages;
};

/// What a mapper does when its device fails, and the CPU beside a device.
struct MapperOptions {
  bool fall_back = true;  ///< go on with a CPU backend of its own; else the DeviceError goes to the caller
  /// Of that backend. Where the backend given is a device, matchers that walk on the host map on it from the start. It
  /// has one thread unless more are asked for.
  CpuOptions cpu;
  /// Called once for each failure, with one line that says what failed and what happens now.
  std::function<void(const std::string&)> warn;
  /// For files without a name: what is far from the robot waits there once the map has become large, on the CPU, and
  /// the scans of a long drive until its end (LoopMapper); empty: that of TMPDIR, or /var/tmp.
  std::string scratch_folder{};
  /// Each match says how sure it is (MatchResult::covariance), for some ten microseconds a scan.
  bool with_covariance = false;
  /// Of LoopMapper: a thread of its own looks for loops while the caller maps; else the caller's does so at the same
  /// keyframes. The results are the same.
  bool loops_beside = true;
};

/// Maps one robot's scans, one after the other.
class Mapper {
 public:
  /// Throws ConfigError that names every violation. The backend must outlive the mapper. The map lives where the
  /// matcher walks from pose to pose: on the backend for `exhaustive`, else on the CPU, and then a device has nothing
  /// to do.
  ///
  /// Where the backend throws DeviceError, at any time from here on, the mapper goes over to a CPU backend of its own:
  /// the map is rebuilt there from what the host knows, the scan in hand is matched again, and the device is asked for
  /// nothing more. Map and poses are the same, bit for bit, as if all had been done on the CPU. From the CPU there is
  /// no way back: its DeviceError goes to the caller, as does every one where fall_back is off.
  Mapper(const MapperConfig& config, Backend& backend, MapperOptions options = {});
  ~Mapper();
  Mapper(const Mapper&) = delete;
  Mapper& operator=(const Mapper&) = delete;

  /// Takes the next scan and the robot's pose by odometry when it was taken (nothing, or a constant, where there is no
  /// odometry) and returns the robot's pose in the map with its evidence. Poses or ranges that are not finite never
  /// reach the map: such a pose counts as no odometry, such a range as no return. Throws InputError when the map would
  /// grow beyond map.max_megacells, with the size needed and the size allowed; the map then stays as it was, the
  /// robot's motion is kept, and mapping may go on. Throws FileError where the map is larger than the memory meant for
  /// it and the disk is full.
  MatchResult process(const LaserScan& scan, const std::optional<Pose2>& T_odom_base) {
    start(scan, T_odom_base);
    return finish();
  }
  MatchResult process(PointScan scan, const std::optional<Pose2>& T_odom_base) {
    start(std::move(scan), T_odom_base);
    return finish();
  }

  /// process() in two steps, one finish() for each start(). A device works on the scan from start() on, and on the map
  /// after finish() has returned, so what the caller does in between costs no time: reading the next scan, drawing.
  void start(const LaserScan& scan, const std::optional<Pose2>& T_odom_base);
  /// The same for returns that are points of the robot's plane: a nodding laser's, levelled, or several lasers' scans.
  void start(PointScan scan, const std::optional<Pose2>& T_odom_base);
  /// With fall_back off throws DeviceError, as does every later call; the map keeps what was merged so far.
  MatchResult finish();

  [[nodiscard]] const MapperConfig& config() const;
  [[nodiscard]] MapperStatistics statistics() const;
  /// The global distance transform on the host, as of this call: to be asked for anew after each scan. Only a new call
  /// brings it up to date, and with local.stretch another map takes its place, which ends the reference; without, the
  /// reference stays valid. Never asks the device.
  [[nodiscard]] const GlobalField& field() const;
  /// Whether the device failed, and the text of its error; empty while it works.
  [[nodiscard]] bool lost_device() const { return !device_loss().empty(); }
  [[nodiscard]] const std::string& device_loss() const;
  /// The device's own cells, those of field() where the matcher walks on the host: to be compared with field(). 1/256
  /// cell, row by row. Throws DeviceError where the device fails; it does not fall back.
  [[nodiscard]] std::vector<std::uint16_t> download_device_cells();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

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

/// The robot was where it had been before.
struct ClosedLoop {
  std::size_t from = 0;  ///< scans, by their number
  std::size_t to = 0;
  Pose2 T_from_to;  ///< as it was measured
  PoseInformation information;
  double weight = 0.0;  ///< how far it is believed, from 0 to 1: its information counts so much
  double off_m = 0.0;   ///< of the measured from the pose in the graph
  double off_rad = 0.0;
  bool is_on = false;
};

/// A place of the path: a node of the graph in which loops are closed.
struct GraphPlace {
  std::size_t scan = 0;  ///< by its number
  Pose2 T_map_base;      ///< where the graph put it; the joint adjustment of all keyframes comes after that
};

/// What was measured between two places that follow each other.
struct PathRelation {
  std::size_t from = 0;  ///< scans, by their number
  std::size_t to = 0;
  Pose2 T_from_to;
  PoseInformation information;  ///< as far as its source is believed now that loops are closed
  bool is_by_wheels = false;    ///< else by the front end, which had the wheels to begin with
};

/// What the wheels get wrong always, with one standard deviation each, and how far they were believed.
struct WheelReport {
  double distance = 0.0;        ///< share that is missing in distances
  double turn = 0.0;            ///< share that is missing in turns
  double turn_rad_per_m = 0.0;  ///< turn that is missing in each metre forward
  double sigma_distance = 0.0;
  double sigma_turn = 0.0;
  double sigma_rad_per_m = 0.0;
  double variance_factor = 1.0;             ///< of what the front end stated for the wheels' steps, as loops find it
  double variance_factor_of_matches = 1.0;  ///< likewise of its own poses
};

/// What closing the loops came to.
struct ClosedPath {
  bool is_closed = false;                   ///< not where it was stopped: then the poses are those of the front end
  std::vector<Pose2> T_map_base;            ///< one a scan
  std::vector<PoseCovariance> covariances;  ///< likewise; empty where it was stopped
  WheelReport wheels;
  std::vector<std::size_t> keyframes;  ///< scans, by their number
  std::vector<ClosedLoop> loops;
  std::vector<GraphPlace> places;  ///< in the order of the path, the first at the origin; empty where it was stopped
  std::vector<PathRelation> path;  ///< by the front end, then by the wheels, each in the order of the path
  std::uint64_t searches = 0;
  std::uint64_t pruned = 0;  ///< keyframes that later passes of a place made needless: they are adjusted as other scans
  std::uint64_t pairs = 0;   ///< of keyframes that were laid on each other
  double rms_m = 0.0;        ///< of their points from the lines of the other
};

/// Loops that took effect while mapping went on.
struct LiveStatistics {
  std::uint64_t places = 0;       ///< reached
  std::uint64_t corrections = 0;  ///< changes of LoopMapper::correction()
  std::uint64_t waits = 0;        ///< scans that waited for loops to be looked for
  double waited_s = 0.0;          ///< all together
  double beside_cpu_s = 0.0;      ///< CPU time of the thread beside; 0 where there is none
};

/// A map as it was known at some keyframe. It stays as it is, for any thread, also when the mapper is gone.
struct FrozenMap {
  std::shared_ptr<const GlobalField> field;  ///< distance field; nothing in it before the first keyframe
  std::size_t keyframes = 0;                 ///< that it holds
  Pose2 T_closed_front;                      ///< LoopMapper::correction() that belongs to it
};

/// The keyframes so far with the loops closed that were found by then.
struct ClosedKeyframes {
  std::vector<Pose2> T_map_base;  ///< in their order
  Pose2 T_closed_front;           ///< that carries later poses of the front end after them
};

/// Maps with loops closed: a front end that matches each scan with a map of the last stretch of the path; beside it a
/// thread that finds where the robot came back; and, once the log has ended, the back end that adjusts all keyframes
/// together, then every scan (docs/loops.md). Two frames: the front end's, whose poses are right relative to those
/// shortly before and never leap, and the closed one, in which places that were seen again lie where they were.
class LoopMapper {
 public:
  /// The step at work, and the share of it that is done.
  using Progress = std::function<void(std::string_view, double)>;

  /// As Mapper; the configuration is that of a mapper without loops, and what the front end does otherwise is set here.
  LoopMapper(const MapperConfig& config, Backend& backend, const MapperOptions& options = {});
  ~LoopMapper();
  LoopMapper(const LoopMapper&) = delete;
  LoopMapper& operator=(const LoopMapper&) = delete;

  /// As Mapper::start and finish: the pose is that of the front end. finish() also rethrows what the look for loops
  /// threw. It waits for that where it is more than eight places, 32 m of path, behind.
  void start(const LaserScan& scan, const std::optional<Pose2>& T_odom_base);
  void start(PointScan scan, const std::optional<Pose2>& T_odom_base);
  MatchResult finish();

  /// For those who steer while mapping goes on: T_closed_front * MatchResult::T_map_base is the pose with the loops
  /// closed that have been found so far. It leaps where loops do; the front end's poses do not. What is found at a
  /// place takes effect eight places later, at a keyframe that the log alone determines: live and offline, with any
  /// number of threads, it has the same values at the same scans.
  [[nodiscard]] const Pose2& correction() const;
  /// The distance field of the keyframes so far, in the closed frame with the loops found by then; which those are
  /// depends on the log alone, when it is ready on the machine. Made by the thread that looks for loops, some 0.5 ms a
  /// keyframe, during which loops wait. Holds what was thrown, as InputError where the map would be beyond
  /// map.max_megacells; std::future_error (broken promise) where the mapper ended before. Not after close().
  std::shared_future<FrozenMap> request_map();
  /// Where the keyframes so far are, once the thread that looks for loops has come to them; it takes next to no time.
  /// As request_map() it is broken where the mapper ends before, and not to be asked for after close().
  std::shared_future<ClosedKeyframes> request_keyframes();
  [[nodiscard]] LiveStatistics live_statistics() const;

  /// To be called once, after the last scan. Where stop() is or becomes true, the path stays as it was driven.
  /// With more than one thread (MapperOptions::cpu) the path is adjusted by all, and the field is still being made when
  /// this returns.
  ClosedPath close(const Progress& progress, const std::function<bool()>& stop);
  /// Waits until the field is made, and gives the CPU seconds of a thread that made it after close(). Throws InputError
  /// where the map would be beyond map.max_megacells, as close() does where there is no such thread.
  double finish_field() const;
  /// The distance field of all keyframes where close() put them; throws as finish_field().
  [[nodiscard]] const GlobalField& field() const;

  [[nodiscard]] const Mapper& front_end() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
