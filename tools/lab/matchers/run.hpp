// The protocol of the paper's tables 1 and 2 on a log. Before every n-th scan is matched, all methods minimise the same
// cost on the current map from the same starts: the odometry's prediction, and growing distances from the global
// solution. Frame: map. One run belongs to one thread. Trials depend on the log, the configuration and the seed alone,
// times on the machine. sum_figures() sums up the trials for each method and each kind of start.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/runs/evaluation/pose_table.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "methods.hpp"

namespace gdtslam {

// How well a scan determines the robot's pose by itself; along a bare corridor it does not. Frame: robot, cells; the
// result does not depend on the frame.

/// The normal equations of sliding and turning a scan along its own lines (point to line [Censi2008]): xx, xy, xt, yy,
/// yt, tt, in cells and radians. Each point's line is the main axis of its neighbours within 25 cm among the eight
/// beams on either side; a point with fewer than two such neighbours does not count. Points in the order of the beams.
std::array<double, 6> line_information(std::span<const PointCells> points, double resolution_m);

/// Ratio of the smaller to the larger eigenvalue of these normal equations over x and y with a free heading (Schur
/// complement). 0 in an endless corridor, 1 if all directions are alike.
double constraint_strength(const std::array<double, 6>& information);

/// Limit below which a scan is weak along a corridor: less than one point in twenty lies across.
inline constexpr double kWeakHold = 0.05;

/// Distance of a start from the global solution, in a random direction and to a random side.
struct StartLevel {
  double distance_m = 0.0;
  double angle_rad = 0.0;
};

struct CompareJob {
  std::vector<std::string> logs;
  ReadOptions read;
  ScanRange range;
  MapperConfig mapper;
  std::vector<MatcherKind> methods;
  std::vector<StartLevel> levels;
  std::uint32_t starts = 1;   ///< for each level, at each scan
  std::uint64_t scans = 200;  ///< scans to measure, evenly over the log
  std::uint64_t seed = 1;
  GlobalLimits global;
};

/// A measured scan.
struct CompareScan {
  std::uint64_t index = 0;  ///< among the scans of the run, from 0
  double stamp_s = 0.0;
  std::uint32_t points = 0;   ///< number of valid points
  Pose2 T_map_base;           ///< the global solution
  double mean_cost_m = 0.0;   ///< at the global solution
  double mean_bound_m = 0.0;  ///< lower bound over the window
  bool is_certified = false;
  double hold = 0.0;     ///< constraint_strength()
  double seconds = 0.0;  ///< time of the global solution
  [[nodiscard]] bool is_weak() const { return hold < kWeakHold; }
};

/// One minimisation. Errors are relative to the global solution, in the map's frame.
struct CompareTrial {
  std::uint32_t scan = 0;    ///< in CompareOutcome::scans
  std::uint32_t method = 0;  ///< in CompareJob::methods
  std::uint32_t level = 0;   ///< 0: the odometry's prediction; else levels[level - 1]
  std::uint32_t start = 0;   ///< number within that level
  double start_m = 0.0;      ///< the start's own error
  double start_rad = 0.0;
  double x_m = 0.0;  ///< absolute errors of the end
  double y_m = 0.0;
  double theta_rad = 0.0;
  double distance_m = 0.0;
  double excess_m = 0.0;    ///< mean cost over the lower bound
  bool is_optimal = false;  ///< by certificate: the excess is within the gap
  std::uint32_t evaluations = 0;
  double seconds = 0.0;  ///< CPU time of all threads, hardly disturbed by other work
  [[nodiscard]] bool is_success() const;
};
inline constexpr double kSuccess_m = 0.02;
inline constexpr double kSuccess_deg = 0.5;

struct CompareOutcome {
  std::vector<CompareScan> scans;
  std::vector<CompareTrial> trials;
  std::uint64_t scans_read = 0;
  std::uint64_t every = 1;    ///< one scan in this number was measured
  std::uint64_t refused = 0;  ///< measured, but not accepted by the mapper: left out
  std::uint64_t too_few = 0;  ///< too few points near the map to be measured
};

/// Called after each scan with the number of scans and the share done (negative if unknown).
using CompareProgress = std::function<void(std::uint64_t, double)>;
/// Throws InputError, FileError, DeviceError; Error(kInterrupted) if stop() becomes true.
CompareOutcome compare(const CompareJob& job, Backend& backend, const CompareProgress& progress,
                       const std::function<bool()>& stop);

struct MethodFigures {
  std::string method;
  ErrorSummary distance_m;
  ErrorSummary x_m;
  ErrorSummary y_m;
  ErrorSummary theta_deg;
  Share success;
  Share optimal;  ///< share of all trials; without a certificate a trial is not optimal
  ErrorSummary evaluations;
  ErrorSummary seconds;
  double time_ratio = 0.0;  ///< mean time over that of simplex; 0 if simplex was not run
};

/// Kinds of scans to sum over.
enum class ScanKind : std::uint8_t {
  kHeld,       ///< solution proven, constrained in every direction
  kWeak,       ///< solution proven, weak along a corridor
  kUncertain,  ///< solution not proven within the limit
};
ScanKind scan_kind(const CompareScan& scan);
std::uint64_t count_kind(const CompareOutcome& outcome, ScanKind kind);

/// The figures of one level of starts (0: the prediction) on scans of a kind, in the order of the methods.
std::vector<MethodFigures> sum_figures(const CompareJob& job, const CompareOutcome& outcome, std::uint32_t level,
                                       ScanKind kind);

/// The distances (m) that one method's trials ended from the solution, in the order of the trials.
std::vector<double> collect_distances(const CompareOutcome& outcome, std::uint32_t method, std::uint32_t level,
                                      ScanKind kind);

}  // namespace gdtslam
