// Geometry of a grid of cells. Frame: map; x right, y up; cell (0, 0) is the lower left one and its centre is the
// origin plus half a cell. An index and a displacement are two types, so that they cannot be mixed up. Thread-safe,
// constant time.
#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace gdtslam {

/// A displacement in cells.
struct CellOffset {
  std::int32_t dx = 0;
  std::int32_t dy = 0;
  friend bool operator==(const CellOffset&, const CellOffset&) = default;
};

/// The absolute position of a cell in its grid.
struct CellIndex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  friend bool operator==(const CellIndex&, const CellIndex&) = default;
  friend CellIndex operator+(CellIndex a, CellOffset d) { return {a.x + d.dx, a.y + d.dy}; }
  friend CellIndex operator-(CellIndex a, CellOffset d) { return {a.x - d.dx, a.y - d.dy}; }
  friend CellOffset operator-(CellIndex a, CellIndex b) { return {a.x - b.x, a.y - b.y}; }
};

/// Half-open box of cells: min inside, end outside.
struct CellBox {
  CellIndex min;
  CellIndex end;
  [[nodiscard]] std::int32_t width() const { return end.x - min.x; }
  [[nodiscard]] std::int32_t height() const { return end.y - min.y; }
  [[nodiscard]] bool empty() const { return end.x <= min.x || end.y <= min.y; }
  [[nodiscard]] bool contains(CellIndex c) const { return c.x >= min.x && c.x < end.x && c.y >= min.y && c.y < end.y; }
  friend bool operator==(const CellBox&, const CellBox&) = default;
};

/// Resolution, origin and size of a grid.
struct GridGeometry {
  double resolution_m = 0.05;
  double origin_x_m = 0.0;  ///< lower left corner of cell (0, 0)
  double origin_y_m = 0.0;
  std::int32_t width = 0;  ///< cells
  std::int32_t height = 0;

  [[nodiscard]] std::size_t cell_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  /// The cell that holds the point; the caller checks contains(). Coordinates beyond int32 are clamped to its limits.
  [[nodiscard]] CellIndex cell_at(const Eigen::Vector2d& point_m) const;
  [[nodiscard]] Eigen::Vector2d cell_centre(CellIndex cell) const;
  [[nodiscard]] bool contains(CellIndex cell) const {
    return cell.x >= 0 && cell.x < width && cell.y >= 0 && cell.y < height;
  }
  friend bool operator==(const GridGeometry&, const GridGeometry&) = default;
};

}  // namespace gdtslam
