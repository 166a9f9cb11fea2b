#include "view_counts.hpp"

#include <algorithm>
#include <bit>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::uint64_t kCountedOfTile = std::uint64_t{kTileSide} * kTileSide;

[[noreturn]] void refuse(std::uint64_t max_cells) {
  throw InputError("the cells that changed cannot be told: more than " + std::to_string(max_cells) +
                   " would be counted; check the log with 'gdtslam doctor' or raise map.max_megacells");
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

// Beside the tiles that are there, for those that are new.
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

}  // namespace gdtslam
