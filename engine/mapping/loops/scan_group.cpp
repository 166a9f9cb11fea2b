#include "scan_group.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/mapping/map/keyframe_map.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastPull = 1.0e-9;  // share of all points' information below which a direction counts as unseen

Matrix3 carried(const Matrix3& covariance, const Pose2& T) {
  const Matrix3 adjoint = adjoint_matrix(T);
  return adjoint * times_transposed(covariance, adjoint);
}

Matrix3 propagated(const Matrix3& gain, const Matrix3& covariance) { return gain * times_transposed(covariance, gain); }

constexpr double kBent_m = 0.02;
constexpr double kBent_rad = 0.003;
constexpr double kSeesTheSame_m = 0.5;  // another keyframe this near adds little to a group
constexpr double kSeesTheSame_rad = 0.5;
constexpr std::size_t kMostToASide = 80;  // keyframes: a robot that turns on the spot makes many without travelling

std::pair<std::size_t, std::size_t> find_stretch(std::span<const double> path_m, std::size_t middle, double half_m) {
  std::size_t first = middle;
  std::size_t last = middle;
  while (first > 0 && path_m[middle] - path_m[first - 1] <= half_m && middle - first < kMostToASide) --first;
  while (last + 1 < path_m.size() && path_m[last + 1] - path_m[middle] <= half_m && last - middle < kMostToASide) {
    ++last;
  }
  return {first, last};
}

// The middle one first, then outward: if several see a wall, the points of the nearest one count.
std::vector<std::size_t> from_middle(std::size_t first, std::size_t middle, std::size_t last) {
  std::vector<std::size_t> order{middle};
  for (std::size_t away = 1; away <= std::max(middle - first, last - middle); ++away) {
    if (middle >= first + away) order.push_back(middle - away);
    if (middle + away <= last) order.push_back(middle + away);
  }
  return order;
}

bool is_beside_any(const std::vector<Pose2>& taken, const Pose2& pose) {
  return std::any_of(taken.begin(), taken.end(), [&](const Pose2& other) {
    const Pose2 off = between(other, pose);
    return translation_length(off) < kSeesTheSame_m && std::fabs(off.theta_rad) < kSeesTheSame_rad;
  });
}

MapperConfig field_config(double resolution_m) {
  MapperConfig config;
  config.map.resolution_m = resolution_m;
  config.merge.threshold_m = resolution_m;
  return config;
}

}  // namespace

GroupDoubt::GroupDoubt(std::span<const StepDoubt> doubts, std::span<const Pose2> in_middle, std::size_t middle)
    : middle_(middle) {
  for (std::size_t i = 0; i < doubts.size(); ++i) {
    steps_.push_back(carried(doubts[i].step, in_middle[i]));
    unseen_.push_back(carried(doubts[i].unseen, in_middle[i]));
  }
}

Matrix3 GroupDoubt::of_pose(std::span<const Matrix3> shapes) const {
  Matrix3 sum;
  if (unseen_.empty()) return sum;
  Matrix3 whole;
  for (const Matrix3& shape : shapes) whole += shape;
  const double least = kLeastPull * (whole(0, 0) + whole(1, 1) + whole(2, 2) + 1.0);
  const Matrix3 pose_by_pull = inverse(whole + Matrix3::diagonal(least, least, least));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (i != middle_) sum += propagated(pose_by_pull * shapes[i], unseen_[i]);
  }
  Matrix3 elsewhere = whole;
  elsewhere -= shapes[middle_];
  sum += propagated(pose_by_pull * elsewhere, unseen_[middle_]);
  Matrix3 behind;
  for (std::size_t i = shapes.size() - 1; i > middle_; --i) {
    behind += shapes[i];
    sum += propagated(pose_by_pull * behind, steps_[i]);
  }
  Matrix3 before;
  for (std::size_t i = 0; i < middle_; ++i) {
    before += shapes[i];
    sum += propagated(pose_by_pull * before, steps_[i + 1]);
  }
  return sum;
}

bool have_points(const KeyframePath& keyframes, std::size_t middle, double half_m) {
  if (keyframes.scans[middle].points() > 0) return true;
  const auto [first, last] = find_stretch(keyframes.path_m, middle, half_m);
  for (std::size_t i = first; i <= last; ++i) {
    if (keyframes.scans[i].points() > 0) return true;
  }
  return false;
}

ScanGroup::ScanGroup(const KeyframePath& keyframes, std::size_t middle, double half_m, double spacing_m)
    : middle_(middle) {
  const auto [first, last] = find_stretch(keyframes.path_m, middle, half_m);
  first_ = first;
  PointThinner thinner(spacing_m);
  std::vector<Beam> beams;
  std::vector<WallPoint> walls;
  for (std::size_t i = first; i <= last; ++i) {
    in_middle_.push_back(between(keyframes.poses[middle], keyframes.poses[i]));
  }
  std::vector<std::vector<Point2>> of_keyframes(in_middle_.size());
  std::vector<Pose2> taken;
  for (const std::size_t i : from_middle(first, middle, last)) {
    if (is_beside_any(taken, in_middle_[i - first])) continue;
    taken.push_back(in_middle_[i - first]);
    const KeptScan& scan = keyframes.scans[i];
    const Pose2& T = in_middle_[i - first];
    const PointMotion in_middle(T);
    const auto take = [&](const Point2& point) {
      beams.push_back({T.translation(), point});
      if (thinner.is_first(point)) of_keyframes[i - first_].push_back(point);
    };
    for (const SurfacePoint& p : scan.surface) {
      const Point2 point = in_middle(p.point());
      take(point);
      walls.push_back({point, in_middle.turned(p.normal()), i - first_});
    }
    for (const LonePoint& p : scan.lone) take(in_middle(p.point()));
  }
  for (const std::vector<Point2>& points : of_keyframes) points_.insert(points_.end(), points.begin(), points.end());
  space_ = std::make_unique<FreeSpace>(beams, walls);
  const bool is_doubted = !keyframes.doubts.empty();
  doubt_.emplace(is_doubted ? keyframes.doubts.subspan(first, last + 1 - first) : keyframes.doubts, in_middle_,
                 middle - first);
}

bool ScanGroup::is_bent(std::span<const Pose2> poses) const {
  for (std::size_t i = 0; i < in_middle_.size(); ++i) {
    const Pose2 off = between(in_middle_[i], between(poses[middle_], poses[first_ + i]));
    if (std::sqrt(off.x_m * off.x_m + off.y_m * off.y_m) > kBent_m || std::fabs(off.theta_rad) > kBent_rad) return true;
  }
  return false;
}

FieldCopy make_distance_field(const std::vector<Point2>& points_m, double resolution_m, Backend& backend,
                              std::mutex& backend_mutex) {
  const MapperConfig config = field_config(resolution_m);
  const std::uint32_t radius = config.map.radius_cells();
  if (radius < 1 || radius > 255) {
    throw ConfigError("distances reach over " + std::to_string(radius) +
                      " cells of the loops' resolution, not 1 to 255");
  }
  const KeyframeCells cells = make_keyframe_cells(points_m, resolution_m, radius);
  const std::lock_guard lock(backend_mutex);
  KeyframeMap map(config, backend);
  StageTimes times;
  map.merge(cells, times);
  return FieldCopy(map.field);
}

std::vector<Point2> every_nth(const std::vector<Point2>& points, std::size_t most) {
  const std::size_t step = (points.size() + most - 1) / std::max<std::size_t>(1, most);
  if (step <= 1) return points;
  std::vector<Point2> taken;
  for (std::size_t i = 0; i < points.size(); i += step) taken.push_back(points[i]);
  return taken;
}

}  // namespace gdtslam
