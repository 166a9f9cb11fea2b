// Maps whole logs: feeds every scan to a Mapper and keeps the trajectory, the evidence against doubtful scans and the
// occupancy map. For a nodding laser also the poses of the scans between the horizontal ones, the 3D cloud, and how
// well consecutive sweeps agree. One run belongs to one thread. If it may use more, its own threads read scans ahead
// and cast them into the occupancy map, with the same result.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/memory/byte_shelf.hpp"
#include "engine/core/side_thread.hpp"
#include "engine/mapping/map/scan_beams.hpp"
#include "engine/runs/drive/cloud_output.hpp"
#include "engine/runs/drive/laser_shelf.hpp"
#include "engine/runs/drive/observation_points.hpp"
#include "engine/runs/drive/stopwatch.hpp"
#include "engine/runs/drive/sweep_check.hpp"
#include "engine/runs/streams/nodding_stream.hpp"
#include "engine/runs/streams/scan_ahead.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/calib/nod_track.hpp"
#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/runs/map_log.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// 580 m x 580 m of 25 mm cells: the limit of read_distance_field().
inline constexpr double kMostCellsInOnePiece = static_cast<double>(std::uint64_t{1} << 29U);

class MapExtent {
 public:
  /// Beams without a return count up to `no_return_free_m`.
  MapExtent(const MapperConfig& config, double no_return_free_m)
      : limit_m_(config.scan.max_range_m), reach_m_(no_return_free_m), resolution_m_(config.map.resolution_m) {}
  /// Extends the range of the laser by this scan. O(beams).
  void see(const LaserScan& scan) {
    const double limit_m = range_limit_m(scan, limit_m_);
    for (const float range : scan.ranges_m) {
      const auto range_m = static_cast<double>(range);
      if (range_m < limit_m) reach_m_ = std::max(reach_m_, range_m);
    }
  }
  void add(const Point2& robot_m) {
    low_m_ = is_empty_ ? robot_m : Point2(low_m_.cwiseMin(robot_m));
    high_m_ = is_empty_ ? robot_m : Point2(high_m_.cwiseMax(robot_m));
    is_empty_ = false;
  }
  /// True if everything that the laser may have seen fits in one piece.
  [[nodiscard]] bool is_one_piece() const {
    if (is_empty_) return true;
    const Point2 side_m = high_m_ - low_m_ + Point2(2.0 * reach_m_, 2.0 * reach_m_);
    return side_m.x() / resolution_m_ * (side_m.y() / resolution_m_) <= kMostCellsInOnePiece;
  }

 private:
  double limit_m_;
  double reach_m_;
  double resolution_m_;
  bool is_empty_ = true;
  Point2 low_m_ = Point2::Zero();
  Point2 high_m_ = Point2::Zero();
};

/// Input for a nodding log besides a MapRequest.
struct NoddingJob {
  NodKind kind = NodKind::kEncoder;
  calib::SweepModel model;
  std::string linkage;  ///< source of the model: a preset's name or a file
  NoddingConfig nodding;
  calib::NodTrackLimits limits;
  SweepCheckConfig check;
};

/// Limits of the occupancy map of a run with that configuration.
OccupancyBuilder::Limits occupancy_limits(const MapperConfig& config);

class MapRun {
 public:
  /// Opens the first log and prepares the mapper. Throws ConfigError, InputError or FileError.
  MapRun(const MapRequest& request, Backend& backend)
      : MapRun(request, backend,
               {request.logs, read_options_of(request.settings.log, request.lenient), request.range}) {}
  /// With open logs. `nodding`: the job of a nodding laser; then the receiver of the points, if any.
  MapRun(const MapRequest& request, Backend& backend, ScanStream scans, const NoddingJob* nodding = nullptr,
         std::unique_ptr<CloudOutput> cloud = nullptr);
  ~MapRun();

  /// Called after each scan with the number of scans and the share done (negative when unknown).
  using Progress = std::function<void(std::uint64_t, double)>;
  /// Call once. Runs to the end, or until stop() is true. Throws InputError if the logs hold no scan that can be
  /// mapped, or, for a nodding laser, no horizontal scan; Error(kInterrupted) if stopped before a scan was mapped; and
  /// DeviceError as Mapper does.
  MapOutcome run(const Progress& progress, const std::function<bool()>& stop);

  /// The map's distance field.
  [[nodiscard]] const GlobalField& field() const;

 private:
  /// The observation after the current one: read, absent, or unreadable.
  struct NextObservation {
    std::optional<Observation> observation;
    std::exception_ptr problem;
  };
  struct Nodding;

  void end_with(const std::exception_ptr& problem);
  void read_next(ScanAhead& ahead, NextObservation& next);
  MatchResult match(const Observation& observation, std::vector<ObservedScan>& places, ScanAhead& ahead,
                    NextObservation& next);
  void report_scans(const Observation& observation, const std::vector<ObservedScan>& places, const MatchResult& match);
  void take_observation(const Observation& observation, const std::vector<ObservedScan>& places,
                        const MatchResult& match);
  void map_flat(const Progress& progress);
  void map_nodding(const Progress& progress);
  void take(const NoddingPose& pose, const NoddingScan& scan);
  void take_match(const MatchResult& result, const Pose2& T_map_base, const LaserScan& scan);
  void count_in(const Pose2& T_map_base);
  void cast(const LaserScan& scan, const Pose2& T_map_base);
  void finish_casting();
  void note_stamp(double stamp_s);
  void finish_nodding();
  void close_loops();
  void take_closed(ClosedPath path);
  void take_keyframe_scans();
  void take_space_path();
  void require_a_map() const;
  void finish();

  MapRequest request_;
  ScanStream scans_;
  std::unique_ptr<Mapper> mapper_;
  LoopClosing* loops_ = nullptr;  ///< the mapper's, if it closes loops
  MapSpeed speed_;
  Shelf<StampedPose> poses_;              ///< poses of scans that have one, in log order
  Shelf<double> match_distances_m_;       ///< mean distance of the points to the map for each accepted match
  std::optional<LaserShelf> scans_kept_;  ///< scans of a flat laser, cast once the path is final
  std::vector<bool> is_kept_;             ///< for each scan, whether its match was accepted
  std::vector<bool> is_merged_;           ///< for each scan of a flat laser, whether it went into the map
  LaserShelf merged_scans_;               ///< the raw scans that did
  ObservationPoints observation_points_;
  Shelf<ObservedScan> observed_;  ///< one for each scan; with loops only
  MapperStatistics beside_;       ///< counts for scans that are not the last of their observation
  MapExtent extent_;
  std::optional<OccupancyBuilder> occupancy_;  ///< none once the map is too large for one piece
  bool has_threads_;
  std::optional<SideThread> casting_;  ///< casts into occupancy_, from the first scan to cast
  std::unique_ptr<Nodding> nodding_;   ///< null: the laser does not nod
  Pose2 T_closed_front_;               ///< last pose reported to listeners
  std::function<bool()> stop_;
  std::string broken_off_;  // the problem that ended the log early
  Stopwatch watch_;
  double first_s_;
  double last_s_;
  MapOutcome outcome_;
};

}  // namespace gdtslam
