// Counts the scans that ended in each cell of a tile, and those that passed through it. A counter of 16 bits is kept as
// bit planes, the lowest bits of all cells together; a plane exists only once a count needs it. A few operations count
// 64 cells, and a cell takes some bits instead of eight bytes. Passes, which are many, wait in twos and in fours before
// they are carried on, so that the higher planes are seldom touched. One object belongs to one thread.
#pragma once

#include <cstdint>
#include <vector>

#include "scan_marks.hpp"

namespace gdtslam {

class TileCounts {
 public:
  struct Cell {
    std::uint32_t ends = 0;
    std::uint32_t passes = 0;
  };

  /// Adds one scan: no cell may be in both. If a counter becomes full, 65535, both counters of its cell are halved,
  /// which keeps their ratio.
  void add(const TileBits& ends, const TileBits& passes);

  /// The cells of a row with at least one end, or one pass.
  [[nodiscard]] std::uint64_t ended(std::size_t row) const;
  [[nodiscard]] std::uint64_t passed(std::size_t row) const;
  [[nodiscard]] Cell at(std::size_t row, unsigned column) const;

 private:
  using Planes = std::vector<TileBits>;  ///< the lowest bit first
  static void increment(Planes& planes, std::size_t first_plane, const TileBits& cells);
  static void halve(Planes& planes, std::size_t row, std::uint64_t cells);
  void halve_full(const Planes& planes);
  void add_passes(const TileBits& cells);
  void settle();

  Planes ends_;
  Planes passes_;
  /// Passes not in the planes yet: these count once, and these twice.
  TileBits ones_{};
  TileBits twos_{};
  bool has_ones_ = false;  ///< else they are all zero
  bool has_twos_ = false;
};

}  // namespace gdtslam
