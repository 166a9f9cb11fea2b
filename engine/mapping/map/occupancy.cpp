#include "gdtslam/mapping/occupancy.hpp"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "gdtslam/core/error.hpp"
#include "scan_beams.hpp"
#include "scan_marks.hpp"
#include "store/growth.hpp"
#include "tile_counts.hpp"

namespace gdtslam {
namespace {

constexpr std::uint64_t kTileCells = std::uint64_t{kTileSide} * kTileSide;
/// Cells of the rectangle for each kept cell: beams see 6 to 22 % of the extent of buildings and streets.
constexpr std::uint64_t kRectangleShare = 4;

std::uint64_t cell_count(const CellBox& box) {
  return static_cast<std::uint64_t>(std::int64_t{box.end.x} - box.min.x) *
         static_cast<std::uint64_t>(std::int64_t{box.end.y} - box.min.y);
}

[[noreturn]] void refuse(const std::string& needed, std::uint64_t allowed) {
  throw InputError("the occupancy map would need " + needed + " cells, " + std::to_string(allowed) +
                   " are allowed; check the log with 'gdtslam doctor' or raise map.max_megacells");
}

std::uint64_t tile_key(CellIndex place) {
  return std::uint64_t{static_cast<std::uint32_t>(place.y)} << 32U | static_cast<std::uint32_t>(place.x);
}
CellIndex tile_place(std::uint64_t key) {
  return {static_cast<std::int32_t>(key & 0xffffffffU), static_cast<std::int32_t>(key >> 32U)};
}

CellIndex first_cell(CellIndex tile) { return {tile.x * kTileSide, tile.y * kTileSide}; }

/// States of the cells of a tile's row.
struct RowStates {
  std::uint64_t occupied = 0;
  std::uint64_t free = 0;
};

// An occupied cell has at least one end, whatever the configuration says.
RowStates read_states(const TileCounts& counts, std::size_t row, const OccupancyConfig& config) {
  RowStates states;
  for (std::uint64_t ended = counts.ended(row); ended != 0; ended &= ended - 1) {
    const auto column = static_cast<unsigned>(std::countr_zero(ended));
    const auto [ends, passes] = counts.at(row, column);
    const double seen = static_cast<double>(ends) + static_cast<double>(passes);
    const bool is_wall =
        static_cast<std::int32_t>(ends) >= config.min_ends && static_cast<double>(ends) >= config.occupied_share * seen;
    if (is_wall) states.occupied |= ended & (~ended + 1);
  }
  states.free = counts.passed(row) & ~states.occupied;
  return states;
}

// `low` is the lower left cell of the tile, in the map.
void draw(const TileCounts& counts, const OccupancyConfig& config, CellOffset low, OccupancyMap& map) {
  for (std::int32_t row = 0; row < kTileSide; ++row) {
    const RowStates states = read_states(counts, static_cast<std::size_t>(row), config);
    for (std::uint64_t seen = states.occupied | states.free; seen != 0; seen &= seen - 1) {
      const std::int32_t column = std::countr_zero(seen);
      const bool is_wall = (states.occupied >> column & 1U) != 0;
      const CellIndex cell{low.dx + column, low.dy + row};
      map.cells.set(static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(map.geometry.width) +
                        static_cast<std::size_t>(cell.x),
                    is_wall ? CellState::kOccupied : CellState::kFree);
    }
  }
}

}  // namespace

std::vector<Option> option_table(OccupancyConfig& config) {
  return {
      {.path = "occupancy.occupied_share",
       .doc =
           "Least share of scans that end in a cell, among those that end in it or pass through, to call it occupied",
       .unit = Unit::kShare,
       .min = 0.001,
       .max = 1.0,
       .value = &config.occupied_share},
      {.path = "occupancy.min_ends",
       .doc = "Fewest scans that must end in a cell to call it occupied",
       .min = 1,
       .max = 65535,
       .value = &config.min_ends},
      {.path = "occupancy.no_return_free",
       .doc = "Length of a beam without return that counts as free space; with 0 beams without return say nothing",
       .unit = Unit::kMetre,
       .min = 0.0,
       .max = 1000.0,
       .value = &config.no_return_free_m},
  };
}

struct OccupancyBuilder::Ray : ScanRay {};

struct OccupancyBuilder::Tiles {
  ScanMarks marks;  ///< marks of the current scan
  std::unordered_map<std::uint64_t, TileCounts> counts;
};

OccupancyBuilder::OccupancyBuilder(const OccupancyConfig& config, const Limits& limits)
    : config_(config), limits_(limits), tiles_(std::make_unique<Tiles>()) {}

OccupancyBuilder::~OccupancyBuilder() = default;

void OccupancyBuilder::update_bearings(const LaserScan& scan) {
  if (bearings_.directions.size() == scan.ranges_m.size() && bearings_.first_rad == scan.first_bearing_rad &&
      bearings_.step_rad == scan.bearing_step_rad) {
    return;
  }
  bearings_ = {scan.first_bearing_rad, scan.bearing_step_rad, beam_directions(scan)};
}

CellBox OccupancyBuilder::collect_rays(const LaserScan& scan, const Pose2& T_map_base) {
  return gdtslam::collect_rays(scan, T_map_base, bearings_.directions,
                               {.resolution_m = limits_.resolution_m,
                                .min_range_m = limits_.min_range_m,
                                .max_range_m = limits_.max_range_m,
                                .no_return_free_m = config_.no_return_free_m},
                               rays_);
}

void OccupancyBuilder::require_room(const CellBox& content) const {
  const bool is_near =
      std::min(content.min.x, content.min.y) > -kFurthestCell && std::max(content.end.x, content.end.y) < kFurthestCell;
  if (is_near && cell_count(content) / kRectangleShare <= limits_.max_cells) return;
  refuse(std::to_string(std::int64_t{content.end.x} - content.min.x) + " x " +
             std::to_string(std::int64_t{content.end.y} - content.min.y),
         kRectangleShare * limits_.max_cells);
}

void OccupancyBuilder::mark_rays(const CellBox& touched) {
  ScanMarks& marks = tiles_->marks;
  marks.clear(touched);
  for (const Ray& ray : rays_) {
    marks.add_ray(ray.start, ray.end);
    if (ray.is_return) marks.add_end(ray.end.cell());
    if (marks.size() * kTileCells > limits_.max_cells)
      refuse(std::to_string(marks.size() * kTileCells), limits_.max_cells);
  }
  std::size_t tiles = tiles_->counts.size();
  if ((tiles + marks.size()) * kTileCells <= limits_.max_cells) return;
  for (std::size_t k = 0; k < marks.size(); ++k) tiles += 1 - tiles_->counts.count(tile_key(marks[k].place));
  if (tiles * kTileCells > limits_.max_cells) refuse(std::to_string(tiles * kTileCells), limits_.max_cells);
}

// A cell in which a beam ended counts as an end, whatever passed through it.
void OccupancyBuilder::count_marks() {
  ScanMarks& marks = tiles_->marks;
  for (std::size_t k = 0; k < marks.size(); ++k) {
    ScanMarks::Tile& tile = marks[k];
    if (tile.has_columns()) transpose(tile.columns);
    for (std::size_t row = 0; row < kTileSide; ++row) {
      tile.rows[row] = (tile.rows[row] | tile.columns[row]) & ~tile.ends[row];
    }
    tiles_->counts[tile_key(tile.place)].add(tile.ends, tile.rows);
  }
}

void OccupancyBuilder::add(const LaserScan& scan, const Pose2& T_map_base) {
  update_bearings(scan);
  const CellBox touched = collect_rays(scan, T_map_base);
  if (rays_.empty()) return;
  const CellBox content = bounding_box(content_, touched);
  require_room(content);
  mark_rays(touched);
  count_marks();
  content_ = content;
}

OccupancyMap OccupancyBuilder::build() const {
  CellBox known;
  for (const auto& [key, counts] : tiles_->counts) {
    const CellIndex low = first_cell(tile_place(key));
    for (std::int32_t row = 0; row < kTileSide; ++row) {
      const RowStates states = read_states(counts, static_cast<std::size_t>(row), config_);
      const std::uint64_t seen = states.occupied | states.free;
      if (seen == 0) continue;
      known = bounding_box(known, {low + CellOffset{std::countr_zero(seen), row},
                                   low + CellOffset{kTileSide - std::countl_zero(seen), row + 1}});
    }
  }
  if (known.empty()) known = {{0, 0}, {1, 1}};
  OccupancyMap map{.geometry = {.resolution_m = limits_.resolution_m,
                                .origin_x_m = known.min.x * limits_.resolution_m,
                                .origin_y_m = known.min.y * limits_.resolution_m,
                                .width = known.width(),
                                .height = known.height()},
                   .cells = {}};
  map.cells = CellStates(map.geometry.cell_count());
  for (const auto& [key, counts] : tiles_->counts) draw(counts, config_, first_cell(tile_place(key)) - known.min, map);
  return map;
}

}  // namespace gdtslam
