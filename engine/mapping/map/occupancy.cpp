#include "gdtslam/mapping/occupancy.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/error.hpp"
#include "growth.hpp"
#include "scan_beams.hpp"

namespace gdtslam {
namespace {

constexpr std::int64_t kSubCells = 512;  // half steps of 1/256 cell
constexpr double kEvenSteps = 256.0;

/// A pose whose sine and cosine are wanted for each beam.
struct Laser {
  explicit Laser(const Pose2& T) : T_map_laser(T), heading(sin_cos(T.theta_rad)) {}
  [[nodiscard]] Point2 in_map(const Point2& d) const {
    return {T_map_laser.x_m + heading.cos * d.x() - heading.sin * d.y(),
            T_map_laser.y_m + heading.sin * d.x() + heading.cos * d.y()};
  }
  Pose2 T_map_laser;
  SinCos<double> heading;
};

CellBox box_of(CellIndex cell) { return {cell, cell + CellOffset{1, 1}}; }

std::uint64_t cells_of(const CellBox& box) {
  return static_cast<std::uint64_t>(std::int64_t{box.end.x} - box.min.x) *
         static_cast<std::uint64_t>(std::int64_t{box.end.y} - box.min.y);
}

// Both counters are halved when one is full, which keeps their ratio.
void increment(std::uint16_t& counter, std::uint16_t& other) {
  if (++counter == std::numeric_limits<std::uint16_t>::max()) {
    counter = static_cast<std::uint16_t>(counter / 2);
    other = static_cast<std::uint16_t>(other / 2);
  }
}

}  // namespace

std::vector<Option> option_table(OccupancyConfig& config) {
  return {
      {.path = "occupancy.occupied_share",
       .doc =
           "least share of scans that end in a cell, among those that end in it or pass through, to call it occupied",
       .unit = Unit::kShare,
       .min = 0.001,
       .max = 1.0,
       .value = &config.occupied_share},
      {.path = "occupancy.min_ends",
       .doc = "fewest scans that must end in a cell to call it occupied",
       .min = 1,
       .max = 65535,
       .value = &config.min_ends},
      {.path = "occupancy.no_return_free",
       .doc = "length of a beam without return that counts as free space; 0: such beams say nothing",
       .unit = Unit::kMetre,
       .min = 0.0,
       .max = 1000.0,
       .value = &config.no_return_free_m},
  };
}

OccupancyBuilder::OccupancyBuilder(const OccupancyConfig& config, const Limits& limits)
    : config_(config), limits_(limits) {}

CellIndex OccupancyBuilder::SubCell::cell() const {
  return {static_cast<std::int32_t>(x >> 9), static_cast<std::int32_t>(y >> 9)};
}

OccupancyBuilder::SubCell OccupancyBuilder::sub_cell_of(const Point2& point_m) const {
  const auto odd = [this](double coordinate_m) {
    const double steps = std::floor(coordinate_m / limits_.resolution_m * kEvenSteps);
    constexpr double kFurthest = static_cast<double>(kFurthestCell) * kEvenSteps;
    return 2 * static_cast<std::int64_t>(std::clamp(steps, -kFurthest, kFurthest)) + 1;
  };
  return {odd(point_m.x()), odd(point_m.y())};
}

void OccupancyBuilder::update_bearings(const LaserScan& scan) {
  if (bearings_.directions.size() == scan.ranges_m.size() && bearings_.first_rad == scan.first_bearing_rad &&
      bearings_.step_rad == scan.bearing_step_rad) {
    return;
  }
  bearings_ = {scan.first_bearing_rad, scan.bearing_step_rad, {}};
  bearings_.directions.reserve(scan.ranges_m.size());
  for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
    const auto [sine, cosine] = beam_direction(scan, k);
    bearings_.directions.emplace_back(cosine, sine);
  }
}

CellBox OccupancyBuilder::collect_rays(const LaserScan& scan, const Pose2& T_map_base) {
  const double limit_m = range_limit_m(scan, limits_.max_range_m);
  const bool moved = is_skewed(scan);
  Laser laser(T_map_base * scan.T_base_laser);
  if (!laser.T_map_laser.is_finite()) throw InputError("a scan of the occupancy map has a pose that is not finite");
  SubCell start = sub_cell_of(laser.T_map_laser.translation());
  CellBox touched;
  rays_.clear();
  for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
    const auto range_m = static_cast<double>(scan.ranges_m[k]);
    if (range_m < limits_.min_range_m) continue;
    const bool is_return = range_m < limit_m;  // false for NaN and infinity
    const double length_m = is_return ? range_m : std::min(config_.no_return_free_m, limit_m);
    if (!(length_m > 0.0)) continue;
    if (moved) {
      laser = Laser(T_map_base * laser_at_beam(scan, k));
      start = sub_cell_of(laser.T_map_laser.translation());
    }
    const Point2 end_m = laser.in_map(bearings_.directions[k] * length_m);
    if (!end_m.allFinite()) continue;
    rays_.push_back({start, sub_cell_of(end_m), is_return});
    touched = hull_of(hull_of(touched, box_of(start.cell())), box_of(rays_.back().end.cell()));
  }
  return touched;
}

std::size_t OccupancyBuilder::index_of(CellIndex map_cell) const {
  const CellOffset d = map_cell - box_.min;
  return static_cast<std::size_t>(d.dy) * static_cast<std::size_t>(box_.width()) + static_cast<std::size_t>(d.dx);
}

void OccupancyBuilder::grow_to_hold(const CellBox& needed) {
  const CellBox content = hull_of(content_, needed);
  const auto fits = [this](const CellBox& box) {
    return std::min(box.min.x, box.min.y) > -kFurthestCell && std::max(box.end.x, box.end.y) < kFurthestCell &&
           cells_of(box) <= limits_.max_cells;
  };
  const std::optional<GridBoxes> grown = grown_to_hold({content_, box_}, needed, fits);
  if (!grown) {
    throw InputError("the occupancy map would need " + std::to_string(std::int64_t{content.end.x} - content.min.x) +
                     " x " + std::to_string(std::int64_t{content.end.y} - content.min.y) + " cells, " +
                     std::to_string(limits_.max_cells) +
                     " are allowed; check the log with 'gdtslam doctor' or raise map.max_megacells");
  }
  content_ = grown->content;
  if (grown->stored != box_) move_to(grown->stored);
}

void OccupancyBuilder::move_to(const CellBox& box) {
  std::vector<Cell> cells(cells_of(box));
  const CellBox kept = common_part(box_, box);
  for (std::int32_t y = kept.min.y; y < kept.end.y; ++y) {
    const auto row = cells_.begin() + static_cast<std::ptrdiff_t>(index_of({kept.min.x, y}));
    const auto target = static_cast<std::ptrdiff_t>(y - box.min.y) * box.width() + (kept.min.x - box.min.x);
    std::copy(row, row + kept.width(), cells.begin() + target);
  }
  cells_ = std::move(cells);
  box_ = box;
}

// Marks the cells from the start up to the end; the cell of a return was marked before.
void OccupancyBuilder::cast(const Ray& ray) {
  const SubCell& start = ray.start;
  const std::int64_t dx = ray.end.x - start.x;
  const std::int64_t dy = ray.end.y - start.y;
  const std::int64_t run_x = std::abs(dx);
  const std::int64_t run_y = std::abs(dy);
  const std::int64_t into_x = start.x & (kSubCells - 1);
  const std::int64_t into_y = start.y & (kSubCells - 1);
  const std::int64_t border_x = dx < 0 ? into_x : kSubCells - into_x;
  const std::int64_t border_y = dy < 0 ? into_y : kSubCells - into_y;
  const std::ptrdiff_t step_x = dx < 0 ? -1 : 1;
  const std::ptrdiff_t step_y = dy < 0 ? -box_.width() : box_.width();
  const CellOffset span = ray.end.cell() - start.cell();
  const std::int64_t steps = std::int64_t{std::abs(span.dx)} + std::abs(span.dy) + (ray.is_return ? 0 : 1);
  // Negative while the next border in x comes before the next one in y: border_x / run_x < border_y / run_y.
  std::int64_t order = border_x * run_y - border_y * run_x;
  auto index = static_cast<std::ptrdiff_t>(index_of(start.cell()));
  for (std::int64_t k = 0; k < steps; ++k) {
    Cell& cell = cells_[static_cast<std::size_t>(index)];
    if (cell.last_scan != scan_) {
      cell.last_scan = scan_;
      increment(cell.passes, cell.ends);
    }
    const bool along_x = order < 0;
    order += along_x ? kSubCells * run_y : -kSubCells * run_x;
    index += along_x ? step_x : step_y;
  }
}

void OccupancyBuilder::add(const LaserScan& scan, const Pose2& T_map_base) {
  update_bearings(scan);
  const CellBox touched = collect_rays(scan, T_map_base);
  if (rays_.empty()) return;
  grow_to_hold(touched);
  ++scan_;
  for (const Ray& ray : rays_) {
    if (!ray.is_return) continue;
    Cell& cell = cells_[index_of(ray.end.cell())];
    if (cell.last_scan == scan_) continue;
    cell.last_scan = scan_;
    increment(cell.ends, cell.passes);
  }
  for (const Ray& ray : rays_) cast(ray);
}

CellState OccupancyBuilder::state_of(const Cell& cell) const {
  const double seen = static_cast<double>(cell.ends) + static_cast<double>(cell.passes);
  if (cell.ends >= config_.min_ends && static_cast<double>(cell.ends) >= config_.occupied_share * seen) {
    return CellState::kOccupied;
  }
  return cell.passes > 0 ? CellState::kFree : CellState::kUnknown;
}

OccupancyMap OccupancyBuilder::build() const {
  CellBox known;
  for (std::int32_t y = box_.min.y; y < box_.end.y; ++y) {
    for (std::int32_t x = box_.min.x; x < box_.end.x; ++x) {
      if (state_of(cells_[index_of({x, y})]) != CellState::kUnknown) known = hull_of(known, box_of({x, y}));
    }
  }
  if (known.empty()) known = {{0, 0}, {1, 1}};
  OccupancyMap map{.geometry = {.resolution_m = limits_.resolution_m,
                                .origin_x_m = known.min.x * limits_.resolution_m,
                                .origin_y_m = known.min.y * limits_.resolution_m,
                                .width = known.width(),
                                .height = known.height()},
                   .cells = {}};
  map.cells.resize(map.geometry.cell_count(), CellState::kUnknown);
  auto cell = map.cells.begin();
  for (std::int32_t y = known.min.y; y < known.end.y; ++y) {
    for (std::int32_t x = known.min.x; x < known.end.x; ++x, ++cell) {
      if (box_.contains({x, y})) *cell = state_of(cells_[index_of({x, y})]);
    }
  }
  return map;
}

}  // namespace gdtslam
