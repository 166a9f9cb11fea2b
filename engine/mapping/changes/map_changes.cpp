#include "map_changes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::uint64_t kCountedOfTile = std::uint64_t{kTileSide} * kTileSide;

[[noreturn]] void refuse(std::uint64_t max_cells) {
  throw InputError("the cells that changed cannot be told: more than " + std::to_string(max_cells) +
                   " would be counted; check the log with 'gdtslam doctor' or raise map.max_megacells");
}

// The cells whose centres lie within the tolerance of a cell's own.
std::vector<CellOffset> make_disc(double tolerance_m, double resolution_m) {
  const double radius = tolerance_m / resolution_m;
  const auto reach = static_cast<std::int32_t>(std::floor(radius));
  std::vector<CellOffset> disc;
  for (std::int32_t dy = -reach; dy <= reach; ++dy) {
    for (std::int32_t dx = -reach; dx <= reach; ++dx) {
      if (dx * dx + dy * dy <= radius * radius) disc.push_back({dx, dy});
    }
  }
  return disc;
}

double share_ended(const CellViews& views) {
  const double seen = static_cast<double>(views.ends) + static_cast<double>(views.passes);
  return seen > 0.0 ? static_cast<double>(views.ends) / seen : 0.0;
}

// At the border of the known map, in a shadow, free cells are often grazed ones.
constexpr double kLeastFreeAround = 0.8;

// True if the map has the cell as free, no wall around it, and knows its surroundings.
bool is_open(const OccupancyMap& map, CellIndex cell, const std::vector<CellOffset>& disc) {
  if (!map.geometry.contains(cell) || map.at(cell) != CellState::kFree) return false;
  std::size_t free = 0;
  for (const CellOffset offset : disc) {
    const CellIndex at = cell + offset;
    const CellState state = map.geometry.contains(at) ? map.at(at) : CellState::kUnknown;
    if (state == CellState::kOccupied) return false;
    free += state == CellState::kFree ? 1 : 0;
  }
  return static_cast<double>(free) >= kLeastFreeAround * static_cast<double>(disc.size());
}

bool is_before(CellIndex a, CellIndex b) { return a.y != b.y ? a.y < b.y : a.x < b.x; }

/// Finds the patches of sorted cells.
class Patches {
 public:
  Patches(std::vector<ChangedCell>& cells, std::int32_t reach) : cells_(cells), reach_(reach), seen_(cells.size()) {}

  /// Numbers the patches, and removes the cells of those with an extent below this many cells.
  void number(std::int32_t least_extent) {
    std::uint32_t patches = 0;
    for (std::size_t first = 0; first < cells_.size(); ++first) {
      if (seen_[first]) continue;
      const std::vector<std::size_t> patch = reached_from(first);
      CellBox box{cells_[first].cell, cells_[first].cell};
      for (const std::size_t k : patch) {
        const CellIndex at = cells_[k].cell;
        box.min = {std::min(box.min.x, at.x), std::min(box.min.y, at.y)};
        box.end = {std::max(box.end.x, at.x), std::max(box.end.y, at.y)};
      }
      const bool is_large = std::max(box.width(), box.height()) + 1 >= least_extent;
      for (const std::size_t k : patch) cells_[k].patch = is_large ? patches : kNoPatch;
      patches += is_large ? 1 : 0;
    }
    std::erase_if(cells_, [](const ChangedCell& cell) { return cell.patch == kNoPatch; });
  }

 private:
  static constexpr std::uint32_t kNoPatch = ~std::uint32_t{0};

  std::vector<std::size_t> reached_from(std::size_t first) {
    std::vector<std::size_t> patch{first};
    seen_[first] = true;
    for (std::size_t next = 0; next < patch.size(); ++next) {
      const CellIndex from = cells_[patch[next]].cell;
      for (std::int32_t y = from.y - reach_; y <= from.y + reach_; ++y) {
        auto cell = std::lower_bound(cells_.begin(), cells_.end(), CellIndex{from.x - reach_, y},
                                     [](const ChangedCell& a, CellIndex b) { return is_before(a.cell, b); });
        for (; cell != cells_.end() && cell->cell.y == y && cell->cell.x <= from.x + reach_; ++cell) {
          const auto k = static_cast<std::size_t>(cell - cells_.begin());
          if (seen_[k]) continue;
          seen_[k] = true;
          patch.push_back(k);
        }
      }
    }
    return patch;
  }

  std::vector<ChangedCell>& cells_;
  std::int32_t reach_;
  std::vector<bool> seen_;
};

// Cells away from walls, free in the map, in which enough views end, and the cells that belong to them.
std::vector<ChangedCell> appeared_cells(const OccupancyMap& map, const ViewCounts& views, const ChangeLimits& limits,
                                        const ViewJudge& judge) {
  const std::vector<CellOffset>& disc = judge.surroundings();
  std::vector<ChangedCell> ended;
  for (const CellIndex cell : views.ended()) {
    const CellViews seen = views.at(cell);
    if (!judge.is_wall(seen, limits.beside_views) || !is_open(map, cell, disc)) continue;
    ended.push_back({.cell = cell, .views = seen});
  }
  std::erase_if(ended, [&](const ChangedCell& changed) {
    return std::none_of(disc.begin(), disc.end(), [&](CellOffset offset) {
      return judge.is_wall(views.at(changed.cell + offset), limits.least_views);
    });
  });
  return ended;
}

}  // namespace

bool ViewCounts::add(const LaserScan& scan, const Pose2& T_grid_base) {
  const Point2 at_m = T_grid_base.translation();
  if (last_m_ && (at_m - *last_m_).norm() < limits_.spacing_m) return false;
  const CellBox touched = collect_rays(scan, T_grid_base, beam_directions(scan), limits_.rays, rays_);
  if (rays_.empty()) return false;
  marks_.clear(touched);
  for (const ScanRay& ray : rays_) {
    marks_.add_ray(ray.start, ray.free_end);
    if (ray.is_return) marks_.add_end(ray.end.cell());
    if (marks_.size() * kCountedOfTile > limits_.max_cells) refuse(limits_.max_cells);
  }
  require_room();
  for (std::size_t k = 0; k < marks_.size(); ++k) {
    ScanMarks::Tile& tile = marks_[k];
    if (tile.has_columns()) transpose(tile.columns);
    for (std::size_t row = 0; row < tile.rows.size(); ++row) {
      tile.rows[row] = (tile.rows[row] | tile.columns[row]) & ~tile.ends[row];
    }
    tiles_[{tile.place.y, tile.place.x}].add(tile.ends, tile.rows);
  }
  last_m_ = at_m;
  ++views_;
  return true;
}

// Counts the existing tiles and the new ones.
void ViewCounts::require_room() {
  std::size_t tiles = tiles_.size();
  if ((tiles + marks_.size()) * kCountedOfTile <= limits_.max_cells) return;
  for (std::size_t k = 0; k < marks_.size(); ++k) tiles += 1 - tiles_.count({marks_[k].place.y, marks_[k].place.x});
  if (tiles * kCountedOfTile > limits_.max_cells) refuse(limits_.max_cells);
}

CellViews ViewCounts::at(CellIndex cell) const {
  const CellIndex tile = cell_tile(cell);
  const auto counts = tiles_.find({tile.y, tile.x});
  if (counts == tiles_.end()) return {};
  return counts->second.at(static_cast<std::size_t>(cell.y & (kTileSide - 1)),
                           static_cast<unsigned>(cell.x & (kTileSide - 1)));
}

template <class RowReader>
std::vector<CellIndex> ViewCounts::collect_cells(RowReader read_row) const {
  std::vector<CellIndex> cells;
  for (const auto& [place, counts] : tiles_) {
    for (std::int32_t row = 0; row < kTileSide; ++row) {
      for (std::uint64_t left = read_row(counts, static_cast<std::size_t>(row)); left != 0; left &= left - 1) {
        cells.push_back({place.second * kTileSide + std::countr_zero(left), place.first * kTileSide + row});
      }
    }
  }
  return cells;
}

std::vector<CellIndex> ViewCounts::ended() const {
  return collect_cells([](const TileCounts& counts, std::size_t row) { return counts.ended(row); });
}

std::vector<CellIndex> ViewCounts::passed() const {
  return collect_cells([](const TileCounts& counts, std::size_t row) { return counts.passed(row); });
}

std::size_t count_patches(std::span<const ChangedCell> cells) {
  std::uint32_t patches = 0;
  for (const ChangedCell& cell : cells) patches = std::max(patches, cell.patch + 1);
  return patches;
}

void keep_patches(std::vector<ChangedCell>& cells, double resolution_m, const ChangeLimits& limits) {
  std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return is_before(a.cell, b.cell); });
  const auto in_cells = [resolution_m](double length_m) {
    return std::max(1, static_cast<std::int32_t>(std::floor(length_m / resolution_m)));
  };
  Patches(cells, in_cells(limits.patch_gap_m)).number(in_cells(limits.tolerance_m));
}

ViewJudge::ViewJudge(double resolution_m, const ChangeLimits& limits)
    : limits_(limits), disc_(make_disc(limits.tolerance_m, resolution_m)) {}

// Noise spreads returns of glass or a wall over some cells, so the ends around count together.
bool ViewJudge::is_free(const ViewCounts& views, CellIndex cell) const {
  const std::uint32_t passes = views.at(cell).passes;
  if (passes < limits_.least_views) return false;
  const auto most_ends = static_cast<std::uint32_t>(limits_.most_contradicted * static_cast<double>(passes));
  std::uint32_t ends = 0;
  return std::all_of(disc_.begin(), disc_.end(), [&](CellOffset offset) {
    const CellViews seen = views.at(cell + offset);
    ends += seen.ends;
    return seen.passes > 0 && ends <= most_ends;
  });
}

bool ViewJudge::is_wall(const CellViews& views, std::uint32_t least_views) const {
  return views.ends >= least_views && share_ended(views) >= limits_.least_share;
}

MapChanges find_changes(const OccupancyMap& map, const ViewCounts& views, const ViewCounts* before,
                        const ChangeLimits& limits) {
  const double r = map.geometry.resolution_m;
  const ViewJudge judge(r, limits);
  MapChanges changes;
  changes.appeared = appeared_cells(map, views, limits, judge);
  for (const CellIndex cell : views.passed()) {
    if (!map.geometry.contains(cell) || map.at(cell) != CellState::kOccupied) continue;
    if (judge.is_free(views, cell)) changes.gone.push_back({.cell = cell, .views = views.at(cell)});
  }
  if (before != nullptr) {
    std::erase_if(changes.appeared, [&](const ChangedCell& changed) { return !judge.is_free(*before, changed.cell); });
    // Half of the beams pass through the cells of a wall along the way.
    std::erase_if(changes.gone, [&](const ChangedCell& changed) {
      return before->at(changed.cell).ends < limits.beside_views || judge.is_free(*before, changed.cell);
    });
  }
  keep_patches(changes.appeared, r, limits);
  keep_patches(changes.gone, r, limits);
  return changes;
}

}  // namespace gdtslam
