// The film of closing loops: the content of each frame, and the run's path between the poses of its graph. The drive
// has a constant pace and pauses while a loop closure bends the path. Then come the last adjustment, the map, and a
// still end. Frames: map; metres. Thread-safe; O(frames), O(poses) to make the path, O(poses shown) to bend it.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/viewer/film.hpp"
#include "source.hpp"

namespace gdtslam {

/// Content of one frame.
struct LoopsInstant {
  double driven_m = 0.0;   ///< distance that the robot has driven
  std::size_t stage = 0;   ///< stage of the path; 0: no loops yet; the last one: adjusted path
  double bent = 1.0;       ///< progress from the stage before (0) to this one (1)
  double map_share = 0.0;  ///< opacity of the map, which fades in at the end
  bool is_over = false;    ///< the robot has arrived
};

/// Number of frames, and how many of them stand still at the end.
struct LoopsFilmLength {
  std::size_t frames = 1;
  std::size_t held = 1;
};

/// Largest number of stages that leaves some frames to bend for each.
std::size_t most_loop_stages(const LoopsFilmLength& length);

/// One entry per frame; the last ones are equal. `stages_m`: distance at the start of each stage of the drive,
/// ascending, without stage 0. `path_m`: length of the whole drive.
std::vector<LoopsInstant> loops_timeline(const std::vector<double>& stages_m, double path_m,
                                         const LoopsFilmLength& length);

class LoopsPath {
 public:
  /// `scans`: the scan of each place, ascending indices into the trajectory, at least one. The walls seen from a place
  /// are taken from the map around its pose in the trajectory.
  LoopsPath(const Trajectory& trajectory, const std::vector<std::size_t>& scans, const OccupancyMap& map);

  [[nodiscard]] double length_m() const { return points_.back().driven_m; }
  [[nodiscard]] double place_m(std::size_t place) const { return places_m_[place]; }
  /// The last place reached.
  [[nodiscard]] std::size_t place_at(double driven_m) const;
  [[nodiscard]] double stamp_at(double driven_m) const;
  /// Poses of the places in the trajectory.
  [[nodiscard]] const std::vector<Pose2>& final_places() const { return T_map_places_; }

  /// The path so far if the places have these poses; between two places both poses are blended by distance.
  [[nodiscard]] std::vector<Point2> bent(const std::vector<Pose2>& T_map_places, double driven_m) const;
  /// Walls seen from the places reached so far.
  [[nodiscard]] std::vector<Point2> walls(const std::vector<Pose2>& T_map_places, double driven_m) const;

 private:
  struct PathPoint {
    double driven_m = 0.0;
    double stamp_s = 0.0;
    std::size_t place = 0;  ///< the last place before
    double share = 0.0;     ///< share of the distance to the next place
    Point2 from_last = Point2::Zero();
    Point2 from_next = Point2::Zero();
  };
  [[nodiscard]] std::vector<PathPoint>::const_iterator end_at(double driven_m) const;

  std::vector<Pose2> T_map_places_;
  std::vector<double> places_m_;
  std::vector<PathPoint> points_;
  std::vector<std::vector<Point2>> walls_;  ///< walls seen from each place, in its frame
};

/// The path is driven as the front end measured it. At each loop closure the graph is solved with the loops known by
/// then, the path bends and the loop lights up; the adjusted path and the map follow at the end. Walls come from the
/// map around each place, because scans are not kept. `source` needs map, trajectory and replay, and must outlive the
/// film. `look`: without a title there are no words. Throws like read_run_graph().
std::unique_ptr<Film> loops_film(RenderSource& source, const MapLook& look, const PictureSize& size,
                                 const LoopsFilmLength& length);

/// Path and walls before and after loop closing at one scale: side by side, or one above the other if the map is wide.
/// Throws like loops_film().
Canvas loops_before_and_after(RenderSource& source, const MapLook& look, const std::optional<PictureSize>& wanted);

}  // namespace gdtslam
