#include "known_surfaces.hpp"

#include <cmath>
#include <utility>

namespace gdtslam {
namespace {

constexpr double kKnownCell_m = 0.2;  // a return counts as known within a cell of one that the map has

std::uint64_t key_of(std::int64_t x, std::int64_t y) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U) | static_cast<std::uint32_t>(y);
}

std::int64_t cell_of(double metres) { return static_cast<std::int64_t>(std::floor(metres / kKnownCell_m)); }

}  // namespace

void KnownSurfaces::add(std::span<const Point2> points_base_m, const Pose2& T_map_base) {
  for (const Point2& point : points_base_m) {
    const Point2 there = T_map_base * point;
    const std::uint64_t key = key_of(cell_of(there.x()), cell_of(there.y()));
    cells_.insert(key);
    next_.insert(key);
  }
}

void KnownSurfaces::begin_stretch() { cells_ = std::exchange(next_, {}); }

bool KnownSurfaces::is_known(const Point2& point_map_m) const {
  const std::int64_t x = cell_of(point_map_m.x());
  const std::int64_t y = cell_of(point_map_m.y());
  for (std::int64_t dy = -1; dy <= 1; ++dy) {
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      if (cells_.contains(key_of(x + dx, y + dy))) return true;
    }
  }
  return false;
}

KeptScan KnownSurfaces::known_part(const KeptScan& scan, const Pose2& T_map_base) const {
  KeptScan known{.surface = {}, .lone = {}, .normal_variance = scan.normal_variance};
  for (const SurfacePoint& p : scan.surface) {
    if (is_known(T_map_base * p.point())) known.surface.push_back(p);
  }
  for (const LonePoint& p : scan.lone) {
    if (is_known(T_map_base * p.point())) known.lone.push_back(p);
  }
  return known;
}

}  // namespace gdtslam
