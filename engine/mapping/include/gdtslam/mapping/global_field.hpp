// The map: the global distance transform (GDT), a field of 1/256 cell that grows with what is seen. Cells hold the
// distance to the nearest obstacle that scans agree on, the cap where nothing is known. Its two outermost rows and
// columns always hold the cap. Cell (0, 0) has fixed map coordinates: growing moves the origin by whole cells. The
// field lives on one backend. Not thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/compute/kernel_options.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {

/// How keyframes are merged, paper equations (9) to (11); 1/256 cell.
struct MergeStep {
  MergeRule rule = MergeRule::kWorking;
  std::uint32_t threshold = 0;
  std::uint32_t lift = 0;  ///< kappa * threshold
};

/// The map's cells on one backend.
class GlobalField {
 public:
  /// Resolution in metres, truncation radius in cells and the most cells that the map may take.
  GlobalField(Backend& backend, double resolution_m, std::uint32_t radius_cells, std::uint64_t max_cells)
      : backend_(&backend), resolution_m_(resolution_m), radius_(radius_cells), max_cells_(max_cells) {}
  GlobalField(const GlobalField&) = delete;
  GlobalField& operator=(const GlobalField&) = delete;

  [[nodiscard]] Backend& backend() const { return *backend_; }
  /// Geometry of the stored grid; its origin is a whole number of cells from the map's origin.
  [[nodiscard]] GridGeometry geometry() const;
  [[nodiscard]] std::uint32_t stride() const { return stride_; }
  [[nodiscard]] std::uint32_t radius_cells() const { return radius_; }
  /// What unknown cells hold, 1/256 cell.
  [[nodiscard]] std::uint16_t cap() const;
  /// Map cells that are stored; cell (0, 0) of the map frame has its lower left corner at the map's origin.
  [[nodiscard]] const CellBox& box() const { return box_; }
  [[nodiscard]] CellIndex first_cell() const { return box_.min; }
  /// The cells where they lie, row-major, stride() from row to row, what lies between the rows unspecified; valid until
  /// the field grows. Empty on a backend whose memory the host does not see.
  [[nodiscard]] std::span<const std::uint16_t> cells() const { return cells_; }
  /// Value at a cell in map cells; the cap outside. Of a field with cells().
  [[nodiscard]] std::uint16_t at(CellIndex map_cell) const;
  [[nodiscard]] const Buffer& buffer() const { return buffer_; }

  /// Makes the grid hold the box (map cells; not empty) and its guard. Throws InputError when it would pass max_cells,
  /// DeviceError where the backend fails (with the size of the map and what bounds it, where that exceeds the largest
  /// buffer), Error where the CPU has no such memory. The grid is as before then.
  void grow_to_hold(const CellBox& map_box);

  /// A copy of the field in the backend's memory, with the same rows. Throws what the backend throws.
  [[nodiscard]] Buffer snapshot() const;
  /// The cells from any backend, rows of stride(), the cap between the rows; empty while the grid is. Throws
  /// DeviceError where the device fails.
  [[nodiscard]] std::vector<std::uint16_t> download() const;
  /// Takes over the cells of another field of the same cap, whose box is given, as its download() gives them; cells of
  /// the grid outside that box become the cap. The grid must hold something: grow_to_hold() comes first. Throws
  /// DeviceError where the device fails.
  void adopt(const std::vector<std::uint16_t>& cells, const CellBox& box);

 private:
  [[nodiscard]] Buffer allocate_for(const CellBox& box) const;
  void move_to(const CellBox& box);
  void copy_into(const Buffer& target, const CellBox& box) const;

  Backend* backend_;
  double resolution_m_;
  std::uint32_t radius_;
  std::uint64_t max_cells_;
  CellBox content_{};  // map cells that have been asked for, their guard included
  CellBox box_{};
  std::uint32_t stride_ = 0;
  Buffer buffer_;
  std::span<const std::uint16_t> cells_;
};

}  // namespace gdtslam
