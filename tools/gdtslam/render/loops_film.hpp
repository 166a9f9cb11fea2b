// The film of closing loops: which frame shows what, and the path of the run between the places of its graph. The drive
// goes at an even pace and stands still while the path bends where loops were found; then come the last adjustment, the
// map, and a moment to look at it. Frames: map; metres. Thread-safe; O(frames), O(poses) to make the path, O(poses
// shown) to bend it.
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
  double driven_m = 0.0;   ///< how far the robot has come
  std::size_t stage = 0;   ///< the loops known: 0 none, one more than the drive has is the adjusted path
  double bent = 1.0;       ///< from the stage before, 0, to this one, 1
  double map_share = 0.0;  ///< share of the map itself, which comes up at the end
  bool is_over = false;    ///< the robot has arrived
};

/// Number of frames, the last of which stand still.
struct LoopsFilmLength {
  std::size_t frames = 1;
  std::size_t held = 1;
};

/// So many stages leave each some frames to bend in.
std::size_t most_loop_stages(const LoopsFilmLength& length);

/// One entry a frame; the last ones are equal. `stages_m`: where on the way each stage of the drive begins, ascending,
/// without stage 0. `path_m`: of the whole drive.
std::vector<LoopsInstant> loops_timeline(const std::vector<double>& stages_m, double path_m,
                                         const LoopsFilmLength& length);

class LoopsPath {
 public:
  /// `scans`: of each place, ascending indices into the trajectory, at least one. What is seen from a place is what the
  /// map has around its pose in the trajectory.
  LoopsPath(const Trajectory& trajectory, const std::vector<std::size_t>& scans, const OccupancyMap& map);

  [[nodiscard]] double length_m() const { return points_.back().driven_m; }
  [[nodiscard]] double place_m(std::size_t place) const { return places_m_[place]; }
  /// The last place that was reached.
  [[nodiscard]] std::size_t place_at(double driven_m) const;
  [[nodiscard]] double stamp_at(double driven_m) const;
  /// The places as the trajectory has them.
  [[nodiscard]] const std::vector<Pose2>& final_places() const { return T_map_places_; }

  /// The path so far with the places at these poses: between two of them by both, in the ratio of the way.
  [[nodiscard]] std::vector<Point2> bent(const std::vector<Pose2>& T_map_places, double driven_m) const;
  /// Walls seen from the places so far.
  [[nodiscard]] std::vector<Point2> walls(const std::vector<Pose2>& T_map_places, double driven_m) const;

 private:
  struct PathPoint {
    double driven_m = 0.0;
    double stamp_s = 0.0;
    std::size_t place = 0;  ///< the last one before
    double share = 0.0;     ///< share of the way to the next
    Point2 from_last = Point2::Zero();
    Point2 from_next = Point2::Zero();
  };
  [[nodiscard]] std::vector<PathPoint>::const_iterator end_at(double driven_m) const;

  std::vector<Pose2> T_map_places_;
  std::vector<double> places_m_;
  std::vector<PathPoint> points_;
  std::vector<std::vector<Point2>> walls_;  ///< walls seen from each place, in its frame
};

/// The path is driven as the front end measured it. Where loops lead back, the graph is solved with those that are
/// known by then, the picture bends and the loop lights up; at the end comes the adjusted path, and the map. Walls are
/// what the map has around each place: scans are not kept. `source` needs map, trajectory and replay, and must outlive
/// the film. `look`: without a title there are no words. Throws as read_run_graph() does.
std::unique_ptr<Film> loops_film(RenderSource& source, const MapLook& look, const PictureSize& size,
                                 const LoopsFilmLength& length);

/// Side by side, or one above the other where the map is wide, to one scale: path and walls as the front end measured
/// them, and as they are with the loops. Throws as loops_film() does.
Canvas loops_before_and_after(RenderSource& source, const MapLook& look, const std::optional<PictureSize>& wanted);

}  // namespace gdtslam
