// The map: the global distance transform (GDT), a field of 1/256 cell that grows as the robot sees more. Cells hold the
// distance to the nearest obstacle that scans agree on; unknown cells hold the cap, as do the two outermost rows and
// columns. Cell (0, 0) has fixed map coordinates. The field lives on one backend. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/grids.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {

class FieldStore;
struct CellRows;

/// How keyframes are merged, paper equations (9) to (11); 1/256 cell.
struct MergeStep {
  MergeRule rule = MergeRule::kWorking;
  std::uint32_t threshold = 0;
  std::uint32_t lift = 0;  ///< kappa * threshold
};

/// The map's cells on one backend. On the CPU it grows without a copy and uses memory only for seen parts. On a device
/// it is a rectangle, which is copied when it grows.
class GlobalField {
 public:
  /// Resolution in metres, truncation radius in cells, and the largest number of cells in memory.
  GlobalField(Backend& backend, double resolution_m, std::uint32_t radius_cells, std::uint64_t max_cells);
  GlobalField(const GlobalField&) = delete;
  GlobalField& operator=(const GlobalField&) = delete;
  ~GlobalField();

  [[nodiscard]] Backend& backend() const { return *backend_; }
  /// Geometry of the box; its origin is a whole number of cells from the map's origin.
  [[nodiscard]] GridGeometry geometry() const;
  [[nodiscard]] std::uint32_t radius_cells() const { return radius_; }
  /// Value of unknown cells, 1/256 cell.
  [[nodiscard]] std::uint16_t cap() const;
  /// Map cells covered by the map; cell (0, 0) of the map frame has its lower left corner at the map's origin.
  [[nodiscard]] const CellBox& box() const { return box_; }
  /// Number of cells in memory.
  [[nodiscard]] std::uint64_t taken_cells() const;

  /// Value at a cell in map cells; the cap outside. On the CPU.
  [[nodiscard]] std::uint16_t at(CellIndex map_cell) const;
  /// Values at a cell, to its right, above it and above that; the cap outside. On the CPU.
  [[nodiscard]] std::array<std::uint16_t, 4> at_and_beside(CellIndex map_cell) const;
  /// Values of a row from a map cell on; the cap outside. On the CPU.
  void read_row(CellIndex first, std::span<std::uint16_t> cells) const;

  /// Stored part of the field, for kernels: all known cells and the guard; the layout of the cells; their buffer; and
  /// the host's view of them, valid until the field grows, empty on a device.
  [[nodiscard]] const CellBox& stored() const;
  [[nodiscard]] const FieldLayout& layout() const;
  [[nodiscard]] const Buffer& buffer() const;
  [[nodiscard]] std::span<const std::uint16_t> memory() const;

  /// Makes the map hold the box (map cells; not empty) and its guard. Throws InputError if it would reach too far or,
  /// on a device, exceed max_cells. Throws DeviceError if the backend fails; if the map exceeds the largest buffer,
  /// with its size and the limit. Throws Error if the CPU has too little memory. The map is then unchanged.
  void grow_to_hold(const CellBox& map_box);
  /// Throws InputError if a merge into these boxes, which the map holds, would take more memory than max_cells allows.
  void require_room(std::span<const CellBox> map_boxes) const;
  /// Notes that a merge writes cells of the box.
  void touch(const CellBox& map_box);

  /// The cells of the box from any backend, row by row; none if the box is empty. Throws DeviceError if the device
  /// fails.
  [[nodiscard]] std::vector<std::uint16_t> download() const;
  /// Takes over the cells of another field of the same cap; cells of the box outside of theirs become the cap. Call
  /// grow_to_hold() first, because the map must not be empty. Throws DeviceError if the device fails.
  void adopt(const CellRows& from);

 private:
  Backend* backend_;
  double resolution_m_;
  std::uint32_t radius_;
  std::uint64_t max_cells_;
  CellBox content_{};  // requested map cells, their guard included
  CellBox box_{};
  std::unique_ptr<FieldStore> store_;
};

/// The rows of a field on the CPU, which must outlive them.
DistanceFieldRows rows_of(const GlobalField& field);

}  // namespace gdtslam
