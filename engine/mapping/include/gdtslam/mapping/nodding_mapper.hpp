// The 3D system of figure 10: scans within a tolerance of horizontal run the 2D system and fix the robot's pose; the
// scans between two fixes get interpolated poses (13), and their beams become points (12), (14). Frames: map. Memory:
// the scans since the last fix. One mapper belongs to one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/nodding.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

/// Interpolation between two fixes. Linear scales (x, y, theta), the evident intention of (13). Geodesic moves along
/// one circle (exp of a share of the log). Odometry follows the wheels' path and spreads its error at the second fix
/// over that path. The error is a motion of the map; each share of it turns about the same centre.
enum class PoseInterpolation : std::uint8_t { kLinear, kGeodesic, kOdometry };

/// How the path between two fixes is smoothed.
struct SmootherConfig {
  bool is_on = true;
  double band_up_m = 1.5;       ///< points up to this much above the map's height count as walls
  double above_floor_m = 0.15;  ///< lower limit of these points, above the floor
  double spacing_m = 0.1;       ///< spacing of the estimated poses; those between lie on circles
  double spacing_rad = 0.05;
  /// Standard deviations of the odometry's random walk until they are estimated from the log. A metre counts as 0.36
  /// rad of turn.
  double odometry_m_per_sqrt_m = 0.02;
  double odometry_rad_per_sqrt_rad = 0.05;
  double point_sigma_m = 0.03;  ///< standard deviation of a point's distance to the map
  double same_view_m = 0.5;     ///< poses this close see the same surfaces: the errors of their points are correlated
  double gate_m = 0.2;          ///< points farther from the map do not count
  std::int32_t max_points = 240;
  std::int32_t independent_points = 40;  ///< the points of a scan weigh at most as much as this many
  std::int32_t iterations = 4;
};

/// The poses that are found: x, y and heading, or also height, roll and pitch, by the surfaces that strokes have in
/// common, once the log has ended.
enum class PoseFreedom : std::uint8_t { kPlane, kSpace };

/// How scans of a nodding laser are used.
struct NoddingConfig {
  double horizontal_rad = 0.017453292519943295;  ///< a scan fixes the pose if all its elevations lie within this
  PoseInterpolation interpolation = PoseInterpolation::kOdometry;
  double prior_limit_sigmas = 1000.0;  ///< instead of PriorConfig::limit_sigmas: see nodding_mapper_config()
  double max_step_m = 5.0;             ///< OdometryConfig::max_step_m of the run, applied here between all scans
  SweepForm form = SweepForm::kWorking;
  SmootherConfig smoother;
  PoseFreedom dof = PoseFreedom::kPlane;
  double max_blind_s = 60.0;  ///< after this long without a horizontal scan a warning is given
};

/// The table of the options, under "nod."; its rows point into `config`.
std::vector<Option> option_table(NoddingConfig& config);

/// A scan with the knots of its elevation. The knots cover all beams; there are none if the elevation is not known.
struct NoddingScan {
  ScanRecord record;
  std::vector<PhaseKnot> knots;
};

/// Properties of the scanner that the assembler needs.
struct NoddingScanner {
  NoddingMount mount;
  ElevationTable table;
  double mirror_rate_hz = 0.0;  ///< for scans without beam times, together with stamp_share
  double stamp_share = 0.5;
  [[nodiscard]] BeamTiming timing(std::size_t beams, double bearing_step_rad) const;
  /// Timing of a scan, which may state it itself; its beams are in the order of time.
  [[nodiscard]] BeamTiming timing(const LaserScan& scan) const;
};

/// Counts over the run so far.
struct NoddingStatistics {
  std::uint64_t fixes = 0;             ///< horizontal scans that the 2D system matched
  std::uint64_t between = 0;           ///< scans with an interpolated pose
  std::uint64_t odometry_leaps = 0;    ///< odometry steps between scans that are longer than max_step_m
  std::uint64_t smoothed = 0;          ///< scans between fixes that the smoother placed with the help of their points
  std::uint64_t by_odometry = 0;       ///< scans posed by odometry from the last fix: at the end, or after a long gap
  std::uint64_t before_first_fix = 0;  ///< scans placed backwards from the first fix
  std::uint64_t dropped = 0;           ///< too long before the first fix: neither pose nor points
  std::uint64_t without_nod = 0;       ///< scans whose elevation is not known: no points
  std::uint64_t sweeps = 0;            ///< strokes of the mount, up or down
  std::uint64_t points = 0;
  double smooth_s = 0.0;    ///< seconds spent on the path between fixes
  double assemble_s = 0.0;  ///< seconds spent on points, including the sink that takes them
};

/// Configuration of the 2D system for a nodding laser. Seconds and metres lie between two fixes, so a match far from
/// the odometry is a place that looks alike rather than a fault of the wheels. The prior therefore does not level off.
/// A step of the odometry may have any length, because leaps are removed before.
MapperConfig nodding_mapper_config(MapperConfig config, const NoddingConfig& nodding);

/// Result for one scan. Only a horizontal scan has a match. A match that was not accepted fixes no pose.
struct NoddingPose {
  std::uint32_t scan = 0;
  double stamp_s = 0.0;
  Pose2 T_map_base;
  std::optional<MatchResult> match;
};

/// Maps the scans of a laser that nods. If the mapper closes loops, poses and points come at the end of the log. The
/// mapper then matches horizontal scans as they come, and once the log has ended all scans are placed between the
/// corrected fixes. Every scan is kept until then: 4 bytes a beam and some 300 bytes a scan.
class NoddingMapper {
 public:
  using PoseSink = std::function<void(const NoddingPose&, const NoddingScan&)>;
  /// The mapper, its backend and the sinks must outlive this. Poses come in log order. No other code may give scans to
  /// `mapper`.
  NoddingMapper(const NoddingConfig& config, const NoddingScanner& scanner, Mapper& mapper, Backend& backend,
                CloudSink& cloud, PoseSink poses, MapperOptions on_failure = {});
  ~NoddingMapper();
  /// Takes the next scan in log order. Throws DeviceError if the device failed and on_failure forbids to continue with
  /// the CPU, and InputError as Mapper does.
  void process(NoddingScan scan);
  /// Call it once, when the log has ended. Throws InputError if no scan was horizontal, with the range of elevations
  /// seen and what to do. If the mapper closes loops, this closes them as LoopClosing::close() does, gives poses and
  /// points of all scans to the sinks and returns the path; otherwise it returns nothing. The path has the scans whose
  /// poses were given, in that order. Between two fixes the covariance is linear in the number of scans; before the
  /// first and after the last fix it is that of the fix. If stop() is true before the loops are closed, the path is
  /// that of the mapper, and all scans get their points. If it becomes true later, the remaining scans get poses and no
  /// points.
  std::optional<ClosedPath> finish(const LoopClosing::Progress& progress, const std::function<bool()>& stop);
  /// The same without reports of progress and without a way to stop.
  std::optional<ClosedPath> finish() {
    return finish([](std::string_view, double) {}, [] { return false; });
  }
  [[nodiscard]] const NoddingStatistics& statistics() const;
  [[nodiscard]] const std::vector<std::string>& warnings() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
