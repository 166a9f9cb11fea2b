// The GDT as a picture that keeps every bit: gdt.png (16-bit grey, top row = highest y) with gdt.yaml
// (docs/formats.md). Values are in 1/256 cell; the cap means "this far or farther, or unknown". The picture holds value
// times a whole scale, the largest that fits, so that it can be looked at. Thread-safe; O(cells).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/mapping/global_field.hpp"

namespace gdtslam {

/// A distance field in memory: row-major, lower left cell first, `stride` cells from row to row.
struct DistanceFieldView {
  GridGeometry geometry;
  std::size_t stride = 0;
  std::span<const std::uint16_t> cells;
  std::uint16_t cap = 0;
  [[nodiscard]] std::uint16_t at(CellIndex cell) const {
    return cells[static_cast<std::size_t>(cell.y) * stride + static_cast<std::size_t>(cell.x)];
  }
};
/// So near to an obstacle, in 1/256 cell, what is drawn of a field is its wall.
inline constexpr std::uint16_t kWallOfField = 128;

/// A distance field that is read row by row, so that one that is not stored in rows need not be copied.
struct DistanceFieldRows {
  GridGeometry geometry;
  std::uint16_t cap = 0;
  std::function<void(std::int32_t y, std::span<std::uint16_t> row)> read;  ///< row y, of the geometry's width
};
DistanceFieldRows rows_of(const DistanceFieldView& field);
/// The rows of a field on the CPU, which must outlive them.
DistanceFieldRows rows_of(const GlobalField& field);

/// Writes the YAML at `yaml_path` and the PNG beside it (the same stem), the YAML last. Throws FileError;
/// InputError when the field has no cells, its cap is 0 or a value lies above the cap.
void write_distance_field(const std::string& yaml_path, const DistanceFieldRows& field);

/// A distance field read from a file; stride = width.
struct DistanceFieldFile {
  GridGeometry geometry;
  std::vector<std::uint16_t> cells;
  std::uint16_t cap = 0;
  [[nodiscard]] DistanceFieldView view() const {
    return {geometry, static_cast<std::size_t>(geometry.width), cells, cap};
  }
};
/// Throws InputError or FileError.
DistanceFieldFile read_distance_field(const std::string& yaml_path);

}  // namespace gdtslam
