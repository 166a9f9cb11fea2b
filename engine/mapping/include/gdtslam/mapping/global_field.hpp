// The map: the global distance transform (GDT), a field of 1/256 cell that grows with what is seen. Cells hold the
// distance to the nearest obstacle that scans agree on, the cap where nothing is known. Its two outermost rows and
// columns always hold the cap. Cell (0, 0) has fixed map coordinates: growing moves the origin by whole cells.
#pragma once

#include <cstdint>
#include <span>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/grid_geometry.hpp"

namespace gdtslam {

class GlobalField {
 public:
  /// Resolution in metres, truncation radius in cells, and the most cells that the map may take.
  GlobalField(Backend& backend, double resolution_m, std::uint32_t radius_cells, std::uint64_t max_cells);

  /// Geometry of the stored grid; its origin is a whole number of cells from the map's origin.
  [[nodiscard]] GridGeometry geometry() const;
  [[nodiscard]] std::uint32_t stride() const { return stride_; }
  [[nodiscard]] std::uint32_t radius_cells() const { return radius_; }
  [[nodiscard]] std::uint16_t cap() const;
  /// Lower left cell in map cells (cell (0, 0) of the map frame has its lower left corner at the map's origin).
  [[nodiscard]] CellIndex first_cell() const { return first_; }
  /// The cells, row-major, stride() from row to row; valid until the next grow or merge.
  [[nodiscard]] std::span<const std::uint16_t> cells() const;
  /// Field value at a cell in map cells; the cap outside.
  [[nodiscard]] std::uint16_t at(CellIndex map_cell) const;
  [[nodiscard]] const Buffer& buffer() const { return buffer_; }

  /// Makes the grid hold the box (map cells) and its guard. Throws InputError when it would pass max_cells.
  void grow_to_hold(const CellBox& map_box);

 private:
  Backend* backend_;
  double resolution_m_;
  std::uint32_t radius_;
  std::uint64_t max_cells_;
  CellIndex first_{};
  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;
  std::uint32_t stride_ = 0;
  Buffer buffer_;
};

}  // namespace gdtslam
