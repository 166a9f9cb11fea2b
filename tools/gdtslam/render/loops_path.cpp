#include "loops_film.hpp"

#include <algorithm>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kLeastBend = 4;  // frames that the eye can follow
constexpr std::size_t kMostBend = 25;
constexpr std::size_t kFadeShare = 12;  // divisor: the map fades in during this fraction of the film

std::size_t fading(const LoopsFilmLength& length) { return length.frames / kFadeShare; }

/// Frames of the drive and of the loop closures.
std::size_t moving(const LoopsFilmLength& length) {
  const std::size_t still = length.held + fading(length);
  return length.frames > still ? length.frames - still : 0;
}

double eased(double share) { return share * share * (3.0 - 2.0 * share); }

class TimelineMaker {
 public:
  explicit TimelineMaker(std::vector<LoopsInstant>& frames) : frames_(frames) {}
  void drive_to(double at_m) {
    now_.driven_m = at_m;
    frames_.push_back(now_);
  }
  void bend(std::size_t stage, std::size_t count) {
    now_.stage = stage;
    for (std::size_t k = 1; k <= count; ++k) {
      now_.bent = eased(static_cast<double>(k) / static_cast<double>(count));
      frames_.push_back(now_);
    }
    now_.bent = 1.0;
  }
  void arrive() { now_.is_over = true; }
  void come_to(double at_m) { now_.driven_m = at_m; }
  void bring_up_map(std::size_t count) {
    for (std::size_t k = 1; k <= count; ++k) {
      now_.map_share = static_cast<double>(k) / static_cast<double>(count + 1);
      frames_.push_back(now_);
    }
    now_.map_share = 1.0;
  }
  void hold(std::size_t count) { frames_.insert(frames_.end(), count, now_); }

 private:
  std::vector<LoopsInstant>& frames_;
  LoopsInstant now_;
};

constexpr double kPointEvery_m = 0.1;
constexpr double kReach_m = 15.0;  // farther away a degree of heading would blur everything
constexpr int kBeams = 720;

/// The robot's own position is free, whatever the map has around it.
constexpr double kOwnPlace_m = 0.25;
constexpr double kStepsPerCell = 8.0;  ///< along a beam: a corner cut by less hides nothing

std::optional<CellIndex> wall_along(const OccupancyMap& map, const Point2& from_m, const Point2& direction,
                                    double reach_m) {
  const double step_m = map.geometry.resolution_m / kStepsPerCell;
  for (double at_m = kOwnPlace_m; at_m <= reach_m; at_m += step_m) {
    const CellIndex cell = map.geometry.cell_at(from_m + at_m * direction);
    if (!map.geometry.contains(cell)) return std::nullopt;
    const CellState state = map.at(cell);
    if (state != CellState::kFree) return state == CellState::kOccupied ? std::optional(cell) : std::nullopt;
  }
  return std::nullopt;
}

/// Centres of all occupied cells visible from the pose, each once, by row and column of the map; in the frame of the
/// pose. A beam also ends at unknown cells, without a wall.
std::vector<Point2> walls_seen_from(const OccupancyMap& map, const Pose2& T_map_pose) {
  std::vector<CellIndex> cells;
  const Point2 from_m = T_map_pose.translation();
  if (!T_map_pose.is_finite() || !map.geometry.contains(map.geometry.cell_at(from_m))) return {};
  for (int k = 0; k < kBeams; ++k) {
    const SinCos<double> turn = sin_cos(2.0 * kPi * k / kBeams);
    const std::optional<CellIndex> wall = wall_along(map, from_m, {turn.cos, turn.sin}, kReach_m);
    if (wall) cells.push_back(*wall);
  }
  const auto is_before = [](CellIndex a, CellIndex b) { return a.y != b.y ? a.y < b.y : a.x < b.x; };
  std::sort(cells.begin(), cells.end(), is_before);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  const Pose2 T_pose_map = inverse(T_map_pose);
  std::vector<Point2> walls;
  walls.reserve(cells.size());
  for (const CellIndex cell : cells) walls.push_back(T_pose_map * map.geometry.cell_centre(cell));
  return walls;
}

}  // namespace

std::size_t most_loop_stages(const LoopsFilmLength& length) {
  return std::max<std::size_t>(2, moving(length) / (2 * kLeastBend)) - 1;
}

std::vector<LoopsInstant> loops_timeline(const std::vector<double>& stages_m, double path_m,
                                         const LoopsFilmLength& length) {
  const std::size_t bends = stages_m.size() + 1;
  const std::size_t bend = std::clamp<std::size_t>(moving(length) / (2 * bends), 1, kMostBend);
  const std::size_t drive = std::max(moving(length), bend * bends + 1) - bend * bends;
  std::vector<LoopsInstant> frames;
  TimelineMaker maker(frames);
  std::size_t stage = 0;
  for (std::size_t k = 1; k <= drive; ++k) {
    const double at_m = path_m * static_cast<double>(k) / static_cast<double>(drive);
    for (; stage < stages_m.size() && (stages_m[stage] <= at_m || k == drive); ++stage) {
      maker.come_to(stages_m[stage]);
      maker.bend(stage + 1, bend);
    }
    maker.drive_to(at_m);
  }
  maker.arrive();
  maker.bend(bends, bend);
  maker.bring_up_map(fading(length));
  maker.hold(length.held);
  // A film that is too short for everything keeps its end.
  const std::size_t count = std::max<std::size_t>(length.frames, 1);
  if (frames.size() > count) frames.erase(frames.begin(), frames.end() - static_cast<std::ptrdiff_t>(count));
  return frames;
}

LoopsPath::LoopsPath(const Trajectory& trajectory, const std::vector<std::size_t>& scans, const OccupancyMap& map) {
  std::vector<double> driven_m(trajectory.size(), 0.0);
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    const Point2 step = trajectory[i].T_map_base.translation() - trajectory[i - 1].T_map_base.translation();
    driven_m[i] = driven_m[i - 1] + step.norm();
  }
  T_map_places_.reserve(scans.size());
  places_m_.reserve(scans.size());
  walls_.reserve(scans.size());
  for (const std::size_t scan : scans) {
    T_map_places_.push_back(trajectory[scan].T_map_base);
    places_m_.push_back(driven_m[scan]);
    walls_.push_back(walls_seen_from(map, trajectory[scan].T_map_base));
  }
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const bool is_last = i + 1 == trajectory.size();
    if (!points_.empty() && !is_last && driven_m[i] - points_.back().driven_m < kPointEvery_m) continue;
    PathPoint point{.driven_m = driven_m[i], .stamp_s = trajectory[i].stamp_s, .place = place_at(driven_m[i])};
    const std::size_t next = std::min(point.place + 1, scans.size() - 1);
    const double way_m = places_m_[next] - places_m_[point.place];
    point.share = way_m > 0.0 ? std::clamp((driven_m[i] - places_m_[point.place]) / way_m, 0.0, 1.0) : 0.0;
    const Point2 at = trajectory[i].T_map_base.translation();
    point.from_last = inverse(T_map_places_[point.place]) * at;
    point.from_next = inverse(T_map_places_[next]) * at;
    points_.push_back(point);
  }
}

std::size_t LoopsPath::place_at(double driven_m) const {
  const auto next = std::upper_bound(places_m_.begin(), places_m_.end(), driven_m);
  return next == places_m_.begin() ? 0 : static_cast<std::size_t>(next - places_m_.begin()) - 1;
}

std::vector<LoopsPath::PathPoint>::const_iterator LoopsPath::end_at(double driven_m) const {
  const auto end = std::upper_bound(points_.begin(), points_.end(), driven_m,
                                    [](double at_m, const PathPoint& point) { return at_m < point.driven_m; });
  return end == points_.begin() ? end + 1 : end;
}

double LoopsPath::stamp_at(double driven_m) const { return std::prev(end_at(driven_m))->stamp_s; }

std::vector<Point2> LoopsPath::bent(const std::vector<Pose2>& T_map_places, double driven_m) const {
  std::vector<Point2> path;
  path.reserve(points_.size());
  for (auto point = points_.begin(); point != end_at(driven_m); ++point) {
    const Point2 by_last = T_map_places[point->place] * point->from_last;
    const std::size_t next = std::min(point->place + 1, T_map_places.size() - 1);
    const Point2 by_next = T_map_places[next] * point->from_next;
    path.emplace_back((1.0 - point->share) * by_last + point->share * by_next);
  }
  return path;
}

std::vector<Point2> LoopsPath::walls(const std::vector<Pose2>& T_map_places, double driven_m) const {
  std::vector<Point2> all;
  const std::size_t last = place_at(driven_m);
  for (std::size_t place = 0; place <= last; ++place) {
    all.reserve(all.size() + walls_[place].size());
    for (const Point2& wall : walls_[place]) all.push_back(T_map_places[place] * wall);
  }
  return all;
}

}  // namespace gdtslam
