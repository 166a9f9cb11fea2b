#include "observation_points.hpp"

#include <cmath>
#include <utility>

#include "engine/runs/motion/scan_speed.hpp"

namespace gdtslam {

ObservationPoints::Laser& ObservationPoints::find_laser(std::size_t number) {
  constexpr std::size_t kMostLasers = 64;
  const std::size_t place = number % kMostLasers;
  if (place >= lasers_.size()) lasers_.resize(place + 1);
  if (!lasers_[place].points) lasers_[place].points.emplace(valid_);
  return lasers_[place];
}

void ObservationPoints::see_odometry(const Observation& observation) {
  for (const ScanRecord& scan : observation) {
    if (!scan.T_odom_base || has_odometry_) continue;
    if (!T_odom_first_) T_odom_first_ = scan.T_odom_base;
    has_odometry_ = !(*T_odom_first_ == *scan.T_odom_base);
  }
}

// Odometry that leaps between two scans is ignored.
Pose2 ObservationPoints::T_last_scan(const ScanRecord& last, const ScanRecord& scan) const {
  const double after_s = scan.scan.stamp_s - last.scan.stamp_s;
  if (has_odometry_ && last.T_odom_base && scan.T_odom_base) {
    const Odometry a{0.0, *last.T_odom_base};
    const Odometry b{std::fabs(after_s), *scan.T_odom_base};
    if (after_s == 0.0 || speed_between(a, b)) return between(a.T_odom_base, b.T_odom_base);
  }
  return speed_ && std::isfinite(after_s) ? exp_se2(after_s * *speed_) : Pose2{};
}

std::vector<ObservedScan> ObservationPoints::place(const Observation& observation) {
  see_odometry(observation);
  std::vector<ObservedScan> places(observation.size());
  for (std::size_t i = 0; i + 1 < observation.size(); ++i) {
    places[i] = {.T_last_scan = T_last_scan(observation.back(), observation[i]), .is_last = false};
  }
  return places;
}

PointScan ObservationPoints::points(const Observation& observation, const std::vector<ObservedScan>& places) {
  PointScan all{.stamp_s = observation.back().scan.stamp_s, .points_base_m = {}};
  std::vector<Point2> unknown_m;
  for (std::size_t i = 0; i < observation.size(); ++i) {
    Laser& laser = find_laser(observation[i].laser);
    std::vector<Point2> points_m = laser.points->of(observation[i].scan);
    if (!places[i].is_last) points_m = in_map(points_m, places[i].T_last_scan);
    std::vector<Point2>& place = laser.is_in_map ? all.points_base_m : unknown_m;
    place.insert(place.end(), points_m.begin(), points_m.end());
  }
  if (!all.points_base_m.empty()) all.unknown_points = unknown_m.size();
  all.points_base_m.insert(all.points_base_m.end(), unknown_m.begin(), unknown_m.end());
  return all;
}

void ObservationPoints::take(const Observation& observation, const MatchResult& match,
                             std::vector<ObservedScan>& places) {
  for (const ScanRecord& scan : observation) {
    Laser& laser = find_laser(scan.laser);
    laser.is_in_map = laser.is_in_map || match.merged;
  }
  const Odometry now{match.stamp_s, match.T_map_base};
  speed_ = last_ ? speed_between(*last_, now) : std::nullopt;
  last_ = now;
  places = place(observation);
}

MatchResult match_of_scan(const MatchResult& match, const ScanRecord& scan, const ObservedScan& place) {
  MatchResult result = match;
  if (place.is_last) return result;
  result.stamp_s = scan.scan.stamp_s;
  result.T_map_base = match.T_map_base * place.T_last_scan;
  result.T_map_predicted = match.T_map_predicted * place.T_last_scan;
  return result;
}

ClosedPath path_of_scans(ClosedPath path, std::span<const ObservedScan> scans) {
  const std::vector<Pose2> T_map_base = std::exchange(path.T_map_base, {});
  const std::vector<PoseCovariance> covariances = std::exchange(path.covariances, {});
  std::vector<std::size_t> last;  // scan of each observation
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const std::size_t k = last.size();
    path.T_map_base.push_back(scans[i].is_last ? T_map_base[k] : T_map_base[k] * scans[i].T_last_scan);
    if (!covariances.empty()) path.covariances.push_back(covariances[k]);
    if (scans[i].is_last) last.push_back(i);
  }
  for (const std::size_t k : std::exchange(path.keyframes, {})) {
    for (std::size_t i = k == 0 ? 0 : last[k - 1] + 1; i <= last[k]; ++i) path.keyframes.push_back(i);
  }
  for (GraphPlace& place : path.places) place.scan = last[place.scan];
  for (ClosedLoop& loop : path.loops) loop.from = last[loop.from], loop.to = last[loop.to];
  for (PathRelation& relation : path.path) relation.from = last[relation.from], relation.to = last[relation.to];
  return path;
}

}  // namespace gdtslam
