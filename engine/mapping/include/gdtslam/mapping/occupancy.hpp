// The occupancy map for planners and people: which cells are occupied, free or unknown, by casting the beams of every
// scan from its final pose. A cell is judged by the scans that ended in it against those that only passed through it,
// each scan counted once per cell and ends before passes, so that neither the order of the beams nor their density near
// the sensor matters [Moravec1985]. Frame: map, its lattice that of the GDT; metres and radians. The cells that a beam
// crosses are exact for end points rounded to 1/256 cell (integer traversal after [AmanatidesWoo1987]). Cost: O(beams x
// rows or columns crossed) per scan. Memory: tiles of 64 x 64 cells where beams went, two bits a cell for each doubling
// of the scans that saw it; nothing is copied when the map grows. One builder belongs to one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

/// States of a map's cells, one after the other: two bits each, and none for stretches of 512 unknown cells. One object
/// belongs to one thread, constant ones to all.
class CellStates {
 public:
  CellStates() = default;
  /// So many unknown cells.
  explicit CellStates(std::size_t size) : size_(size), blocks_((size + kBlock - 1) / kBlock) {}
  explicit CellStates(std::span<const CellState> states);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] CellState operator[](std::size_t cell) const {
    const std::uint32_t block = blocks_[cell / kBlock];
    return block == 0 ? CellState::kUnknown : state_in(pool_[block - 1], cell % kBlock);
  }
  void set(std::size_t cell, CellState state) {
    std::uint32_t& block = blocks_[cell / kBlock];
    if (block == 0) {
      if (state == CellState::kUnknown) return;
      pool_.push_back({});
      block = static_cast<std::uint32_t>(pool_.size());
    }
    std::uint64_t& word = pool_[block - 1][cell % kBlock / kInWord];
    const std::size_t shift = 2 * (cell % kInWord);
    word = (word & ~(std::uint64_t{3} << shift)) | static_cast<std::uint64_t>(state) << shift;
  }
  /// The states from a cell on.
  void read(std::size_t first, std::span<CellState> states) const;
  [[nodiscard]] std::vector<CellState> all() const;
  friend bool operator==(const CellStates& a, const CellStates& b) { return a.all() == b.all(); }

 private:
  static constexpr std::size_t kBlock = 512;
  static constexpr std::size_t kInWord = 32;
  using Block = std::array<std::uint64_t, kBlock / kInWord>;
  static CellState state_in(const Block& block, std::size_t cell) {
    return static_cast<CellState>(block[cell / kInWord] >> (2 * (cell % kInWord)) & 3U);
  }

  std::size_t size_ = 0;
  std::vector<std::uint32_t> blocks_;  // 0, or one more than its place in the pool
  std::deque<Block> pool_;
};

/// Row-major, the lower left cell first; as small as what was seen allows.
struct OccupancyMap {
  GridGeometry geometry;
  CellStates cells;
  [[nodiscard]] CellState at(CellIndex cell) const {
    return cells[static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(geometry.width) +
                 static_cast<std::size_t>(cell.x)];
  }
  /// The states of a row, of the geometry's width.
  void read_row(std::int32_t y, std::span<CellState> states) const {
    cells.read(static_cast<std::size_t>(y) * static_cast<std::size_t>(geometry.width), states);
  }
};

/// How many beams make a cell a wall or free.
struct OccupancyConfig {
  double occupied_share = 0.25;   ///< least share of ends among the scans that saw the cell
  std::int32_t min_ends = 2;      ///< fewest scans that must end in an occupied cell
  double no_return_free_m = 0.0;  ///< free space along a beam without return; 0: such beams say nothing
};

/// The table of the options, under "occupancy."; its rows point into `config`.
std::vector<Option> option_table(OccupancyConfig& config);

/// An occupancy map that is being made, scan by scan.
class OccupancyBuilder {
 public:
  struct Limits {
    double resolution_m = MapConfig{}.resolution_m;
    double min_range_m = ScanConfig{}.min_range_m;  ///< shorter ranges are dropped
    double max_range_m = ScanConfig{}.max_range_m;  ///< at or above it, or the sensor's own limit, a range is no return
    /// That are kept, in whole tiles; the map around them, which is mostly unknown, may have four times as many.
    std::uint64_t max_cells = std::uint64_t{2048} << 20U;
  };
  OccupancyBuilder(const OccupancyConfig& config, const Limits& limits);
  ~OccupancyBuilder();

  /// Casts the scan's beams from the robot's final pose, each from where the laser was when it measured it. Ranges that
  /// are not finite are no returns. Throws InputError when the map would pass max_cells; the builder is unchanged
  /// then.
  void add(const LaserScan& scan, const Pose2& T_map_base);

  /// The map of what was added so far; 1 x 1 unknown cell when nothing was.
  [[nodiscard]] OccupancyMap build() const;

 private:
  struct Ray;
  struct Bearings {
    double first_rad = 0.0;
    double step_rad = 0.0;
    std::vector<Point2> directions;
  };
  struct Tiles;

  void update_bearings(const LaserScan& scan);
  CellBox collect_rays(const LaserScan& scan, const Pose2& T_map_base);
  void require_room(const CellBox& content) const;
  void mark_rays(const CellBox& touched);
  void count_marks();

  OccupancyConfig config_;
  Limits limits_;
  CellBox content_{};  ///< map cells that rays have reached
  std::unique_ptr<Tiles> tiles_;
  std::vector<Ray> rays_;
  Bearings bearings_;
};

}  // namespace gdtslam
