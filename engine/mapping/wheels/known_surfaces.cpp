#include "known_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gdtslam {
namespace {

constexpr double kKnownCell_m = 0.2;  // a return counts as known within a cell of a return in the map
constexpr double kToEachSide_m = 0.5;

std::uint64_t cell_key(std::int64_t x, std::int64_t y) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U) | static_cast<std::uint32_t>(y);
}

std::int64_t grid_coordinate(double metres) { return static_cast<std::int64_t>(std::floor(metres / kKnownCell_m)); }

}  // namespace

void KnownSurfaces::add(std::span<const Point2> points_base_m, const Pose2& T_map_base) {
  const PointMotion in_map(T_map_base);
  for (const Point2& point : points_base_m) {
    const Point2 there = in_map(point);
    add_cell(grid_coordinate(there.x()), grid_coordinate(there.y()), cells_);
    add_cell(grid_coordinate(there.x()), grid_coordinate(there.y()), next_);
  }
  ++keyframes_;
}

// Keyframes come in order, so the first one to reach a cell stays.
void KnownSurfaces::add_cell(std::int64_t x, std::int64_t y, Cells& cells) const {
  Known& here = cells.try_emplace(cell_key(x, y), Known{keyframes_}).first->second;
  if (std::exchange(here.has_return, true)) return;
  for (std::int64_t dy = -1; dy <= 1; ++dy) {
    for (std::int64_t dx = -1; dx <= 1; ++dx) cells.try_emplace(cell_key(x + dx, y + dy), Known{keyframes_});
  }
}

void KnownSurfaces::begin_stretch() { cells_ = std::exchange(next_, {}); }

std::optional<std::size_t> KnownSurfaces::first_near(const Point2& point_map_m) const {
  const auto cell = cells_.find(cell_key(grid_coordinate(point_map_m.x()), grid_coordinate(point_map_m.y())));
  return cell != cells_.end() ? std::optional(cell->second.first) : std::nullopt;
}

std::size_t KnownSurfaces::first_seen(const Point2& point_map_m) const { return first_near(point_map_m).value(); }

bool KnownSurfaces::goes_on(const Point2& point_map_m, const Point2& direction) const {
  return first_near(point_map_m + kToEachSide_m * direction) && first_near(point_map_m - kToEachSide_m * direction);
}

std::vector<Point2> KnownSurfaces::without_wall_ends(std::span<const Point2> points_base_m,
                                                     const Pose2& T_map_base) const {
  const Pose2 turn{0.0, 0.0, T_map_base.theta_rad};
  std::vector<Point2> kept_m;
  kept_m.reserve(points_base_m.size());
  for (std::size_t i = 0; i < points_base_m.size(); ++i) {
    const std::optional<Point2> along = lone_on_wall(points_base_m, i);
    if (!along || goes_on(T_map_base * points_base_m[i], turn * *along)) kept_m.push_back(points_base_m[i]);
  }
  return kept_m;
}

KeptScan KnownSurfaces::known_part(const KeptScan& scan, const Pose2& T_map_base) const {
  const PointMotion in_map(T_map_base);
  const auto select_known = [&](const auto& points) {
    auto known = points;
    std::erase_if(known, [&](const auto& p) { return !first_near(in_map(p.point())); });
    return known;
  };
  return {.surface = select_known(scan.surface),
          .lone = select_known(scan.lone),
          .normal_variance = scan.normal_variance,
          .corners = select_known(scan.corners)};
}

}  // namespace gdtslam
