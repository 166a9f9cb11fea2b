// Storage of a map's cells. On the CPU they lie in strips of memory that the system provides at the first access, so
// nothing is copied when the map grows and unknown parts take none (FieldStrips). On a device they lie in rows of one
// rectangle, which is copied when it has to grow (FieldRows). Boxes are of map cells. Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "growth.hpp"

namespace gdtslam {

/// Cells in rows of a stride, with the box they belong to.
struct CellRows {
  std::span<const std::uint16_t> cells;
  std::size_t stride = 0;
  CellBox box;
};

class FieldStore {
 public:
  FieldStore() = default;
  FieldStore(const FieldStore&) = delete;
  FieldStore& operator=(const FieldStore&) = delete;
  virtual ~FieldStore() = default;

  /// True if hold() may be called with the box.
  [[nodiscard]] virtual bool can_hold(const CellBox& box) const = 0;
  /// Returns the end of a sentence that states which limit a larger map exceeds and what to do.
  [[nodiscard]] virtual std::string limit() const = 0;
  /// Makes room for the content, the cells known or about to be known; if growing copies the store, also for the box
  /// around it. Throws DeviceError if a device fails, Error if there is no such memory; all is unchanged then.
  virtual void hold(const GridBoxes& boxes) = 0;
  /// Notes that the cells of the box may be known from now on.
  virtual void touch(const CellBox& box) = 0;
  /// Number of cells for which touch() would take memory.
  [[nodiscard]] virtual std::uint64_t untaken_cells(const CellBox& box) const = 0;
  /// False if no cell of the row's part within one tile can be known, and its memory is better not read.
  [[nodiscard]] virtual bool may_know(CellIndex cell) const = 0;
  /// Number of cells in memory.
  [[nodiscard]] virtual std::uint64_t taken_cells() const = 0;
  /// The cells of the box given to hold(), row by row. Throws DeviceError if a device fails.
  [[nodiscard]] virtual std::vector<std::uint16_t> read() const = 0;
  /// Takes over these cells; those outside of their box become the cap.
  virtual void write(const CellRows& from) = 0;

  /// Cells of a row from `first` on, the cap outside the stored part; for memory that the host can read.
  void read_row(CellIndex first, std::span<std::uint16_t> cells, std::uint16_t cap) const;

  /// Box in the buffer, at least the content; empty at first.
  [[nodiscard]] const CellBox& stored() const { return stored_; }
  [[nodiscard]] const FieldLayout& layout() const { return layout_; }
  [[nodiscard]] const Buffer& buffer() const { return buffer_; }
  /// The memory, if the host can read it.
  [[nodiscard]] std::span<const std::uint16_t> memory() const { return memory_; }

 protected:
  CellBox stored_{};
  FieldLayout layout_{};
  Buffer buffer_;
  std::span<std::uint16_t> memory_;
};

/// In strips if the backend is the CPU, else in rows of at most `max_cells`.
std::unique_ptr<FieldStore> make_field_store(Backend& backend, std::uint16_t cap, std::uint64_t max_cells);

/// The end of such a sentence if the option map.max_megacells is the limit.
std::string limit_of_option(std::uint64_t max_cells);

}  // namespace gdtslam
