#include "scan_group.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/elementary.hpp"
#include "engine/mapping/loops/point_thinner.hpp"

namespace gdtslam {
namespace {

constexpr double kBent_m = 0.02;
constexpr double kBent_rad = 0.003;
constexpr std::size_t kMostToASide = 80;  // keyframes: a robot that turns on the spot makes many in no path

std::pair<std::size_t, std::size_t> find_stretch(std::span<const double> path_m, std::size_t middle, double half_m) {
  std::size_t first = middle;
  std::size_t last = middle;
  while (first > 0 && path_m[middle] - path_m[first - 1] <= half_m && middle - first < kMostToASide) --first;
  while (last + 1 < path_m.size() && path_m[last + 1] - path_m[middle] <= half_m && last - middle < kMostToASide) {
    ++last;
  }
  return {first, last};
}

// The middle one first, then outward: of a wall that several see, what the nearest of them saw counts.
std::vector<std::size_t> from_middle(std::size_t first, std::size_t middle, std::size_t last) {
  std::vector<std::size_t> order{middle};
  for (std::size_t away = 1; away <= std::max(middle - first, last - middle); ++away) {
    if (middle >= first + away) order.push_back(middle - away);
    if (middle + away <= last) order.push_back(middle + away);
  }
  return order;
}

Point2 turned(const SinCos<double>& turn, const Point2& v) {
  return {turn.cos * v.x() - turn.sin * v.y(), turn.sin * v.x() + turn.cos * v.y()};
}

}  // namespace

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
  for (const std::size_t i : from_middle(first, middle, last)) {
    const KeptScan& scan = keyframes.scans[i];
    const Pose2& T = in_middle_[i - first];
    const SinCos<double> turn = sin_cos(T.theta_rad);
    const auto take = [&](const Point2& point) {
      beams.push_back({T.translation(), point});
      if (thinner.is_first(point)) of_keyframes[i - first_].push_back(point);
    };
    for (const SurfacePoint& p : scan.surface) {
      const Point2 point = T * p.point();
      take(point);
      walls.push_back({point, turned(turn, p.normal()), i - first_});
    }
    for (const LonePoint& p : scan.lone) take(T * p.point());
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

}  // namespace gdtslam
