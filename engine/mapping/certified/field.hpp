// A distance field prepared for lower bounds over boxes of poses. For each spacing of boxes it has the least value in
// squares of several sizes around samples of the map, in bytes, in the layout of the kernel PoseBounds. Frame: map
// cells, cell (0, 0) at the map's origin. Thread-safe once made. Cost: a few passes over the map for each square.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {

/// The fields for boxes of one width.
struct BoundLevel {
  static constexpr std::size_t kDilations = 4;
  std::int32_t spacing_bits = 0;  ///< boxes are 2^spacing_bits cells wide
  std::int32_t phase_bits = 0;    ///< and have 2^phase_bits samples along a side
  CellIndex origin;               ///< map cell of the first sample after the margin
  std::uint32_t width = 0;        ///< columns of a plane, with kMargin columns on either side
  std::uint32_t height = 0;
  std::array<std::int32_t, kDilations> dilation_cells{};  ///< half widths of the squares
  std::array<std::uint32_t, kDilations> first_sample{};   ///< index of the first sample of each dilation in `samples`
  std::vector<std::uint8_t> samples;

  [[nodiscard]] std::int32_t sample_bits() const { return spacing_bits - phase_bits; }
  /// Samples beyond the map on every side, so that tiles may begin there.
  static constexpr std::int32_t kMargin = 16;
};

/// Anchors of searches and origins of levels are multiples of this, in cells.
constexpr std::int32_t kBoundAlignment = 64;
/// The largest multiple of kBoundAlignment that does not exceed `cell`.
std::int32_t aligned_down(std::int32_t cell);

/// Affine minorants of the field around each cell, for squares of several half widths.
struct MinorantLevels {
  static constexpr std::array<std::uint32_t, 3> kReaches{1, 2, 3};  ///< cells
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t constant_unit = 1;
  std::array<std::uint32_t, kReaches.size()> first_word{};
  std::vector<std::uint32_t> words;
};

class BoundFields {
 public:
  /// The widest boxes are 32 cells wide, 8 for small windows, 2 for near ones; these two have no minorants. Throws like
  /// require_countable() before it takes memory.
  BoundFields(const FieldView& field, Isa isa, CertifiedMap::Windows windows);

  /// Levels from wide boxes to narrow ones, each half as wide as the one before; the narrowest are two cells wide.
  [[nodiscard]] std::span<const BoundLevel> levels() const { return levels_; }
  /// Factor that turns a sample into a lower bound in 1/256 cell.
  [[nodiscard]] std::uint32_t unit() const { return unit_; }
  [[nodiscard]] const MinorantLevels& minorants() const { return minorants_; }
  [[nodiscard]] bool has_minorants() const { return !minorants_.words.empty(); }
  [[nodiscard]] std::size_t bytes() const;
  /// Most bytes in use at once while they are made for a field of that size.
  static std::uint64_t most_bytes(std::uint64_t width, std::uint64_t height, CertifiedMap::Windows windows);
  /// Throws InputError if 32 bits cannot count the samples or minorants of a field of that size, as the kernels need:
  /// from some 32,400 x 32,400 cells on.
  static void require_countable(std::uint64_t width, std::uint64_t height, CertifiedMap::Windows windows);

 private:
  std::uint32_t unit_ = 1;
  std::vector<BoundLevel> levels_;
  MinorantLevels minorants_;
};

}  // namespace gdtslam
