// The 2D system of figure 5: one scan in, one pose out. Frames: the map's origin is the robot's pose at the first scan.
// One mapper belongs to one thread; its backend may use more. Cost: docs/benchmarks.md.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/loop_closing.hpp"
#include "gdtslam/mapping/match.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {

/// Behaviour of a mapper when its device fails, and the CPU that works next to a device.
struct MapperOptions {
  bool fall_back = true;  ///< continue with a CPU backend of its own; else the DeviceError goes to the caller
  /// Options of that backend. If the given backend is a device, matchers on the host use this one for their map from
  /// the start. It has one thread by default.
  CpuOptions cpu{};
  /// Called once for each failure, with one line that names the failure and its consequence.
  std::function<void(const std::string&)> warn{};
  /// Folder for unnamed temporary files. If loops are closed, the scans of a long drive are kept there until its end.
  /// Empty: that of TMPDIR, or /var/tmp.
  std::string scratch_folder{};
  /// Each match states its covariance (MatchResult::covariance), for some ten microseconds a scan.
  bool with_covariance = false;
  bool with_loops = false;  ///< loops are closed (Mapper::loops)
  /// A second thread searches for loops while the caller maps; else the caller's thread searches at the same keyframes.
  /// The results are the same.
  bool loops_beside = true;
};

/// Maps one robot's scans, one after the other.
class Mapper {
 public:
  /// Throws ConfigError that names every violation. The backend must outlive the mapper. The map lives on the CPU. For
  /// `gauss-newton` and `exhaustive` it also lives on the backend, which matches it; other matchers do not use a
  /// device.
  ///
  /// If the backend throws DeviceError at any later time, the mapper changes to a CPU backend of its own. It matches
  /// the current scan again there and no longer uses the device. Map and poses are the same, bit for bit, as if all had
  /// been done on the CPU. A DeviceError of the CPU goes to the caller, and again at each later call; so does every
  /// DeviceError if fall_back is off.
  Mapper(const MapperConfig& config, Backend& backend, MapperOptions options = {});
  ~Mapper();
  Mapper(const Mapper&) = delete;
  Mapper& operator=(const Mapper&) = delete;

  /// Takes the next scan and the robot's pose by odometry when it was taken (nothing, or a constant, if there is no
  /// odometry) and returns the robot's pose in the map with its evidence. Poses or ranges that are not finite never
  /// reach the map: such a pose counts as no odometry, such a range as no return. Throws InputError when the map would
  /// grow beyond map.max_megacells, with the size needed and the size allowed; the map then stays as it was, the
  /// robot's motion is kept, and mapping may continue. Also throws the exceptions of LoopClosing::take().
  MatchResult process(const LaserScan& scan, const std::optional<Pose2>& T_odom_base);
  /// The same for returns given as points in the robot's plane: a nodding laser's, levelled, or several lasers' scans.
  MatchResult process(PointScan scan, const std::optional<Pose2>& T_odom_base);

  /// The configuration in use: with loops, LoopClosing::adapt_config() of the given one.
  [[nodiscard]] const MapperConfig& config() const;
  [[nodiscard]] MapperStatistics statistics() const;
  /// The distance field that scans are matched with, on the host, as of this call. With local.stretch another map
  /// replaces it now and then, which ends the reference; without, the reference stays valid. Never uses the device.
  [[nodiscard]] const GlobalField& field() const;
  /// The loops; null without MapperOptions::with_loops.
  [[nodiscard]] LoopClosing* loops() const;
  /// Text of the error that the device failed with; empty while it works.
  [[nodiscard]] const std::string& device_loss() const;
  /// The device's own cells, to compare with field(); those of field() if the matcher runs on the host. 1/256 cell, row
  /// by row. Throws DeviceError if the device fails; it does not fall back.
  [[nodiscard]] std::vector<std::uint16_t> download_device_cells();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
