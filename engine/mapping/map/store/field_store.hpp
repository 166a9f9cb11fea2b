// Storage of a map's cells. On the CPU they lie in strips of memory that the system gives when it is touched, so that
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

/// Cells behind one another in rows of a stride, with what they belong to.
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

  /// Whether hold() may be asked for the box.
  [[nodiscard]] virtual bool can_hold(const CellBox& box) const = 0;
  /// Returns the text, as the end of a sentence, that says which limit a larger map exceeds and what to do.
  [[nodiscard]] virtual std::string limit() const = 0;
  /// Makes room for the content, which is what is known and about to be, and where growing copies what is stored for
  /// the box around it. Throws DeviceError where a device fails, Error
  /// where there is no such memory; all is as before then.
  virtual void hold(const GridBoxes& boxes) = 0;
  /// Notes that the cells of the box may be known from now on.
  virtual void touch(const CellBox& box) = 0;
  /// Cells that touch() would take memory for.
  [[nodiscard]] virtual std::uint64_t untaken_cells(const CellBox& box) const = 0;
  /// Cells that memory was taken for.
  [[nodiscard]] virtual std::uint64_t taken_cells() const = 0;
  /// The cells of the box that was given to hold(), row by row. Throws DeviceError where a device fails.
  [[nodiscard]] virtual std::vector<std::uint16_t> read() const = 0;
  /// Takes these cells over; those outside of their box become the cap.
  virtual void write(const CellRows& from) = 0;

  /// Cells of a row from `first` on, the cap where none are stored; where the host sees them.
  void read_row(CellIndex first, std::span<std::uint16_t> cells, std::uint16_t cap) const;

  /// Box that the buffer holds, at least the content; empty before.
  [[nodiscard]] const CellBox& stored() const { return stored_; }
  [[nodiscard]] const FieldLayout& layout() const { return layout_; }
  [[nodiscard]] const Buffer& buffer() const { return buffer_; }
  /// The memory, where the host sees it.
  [[nodiscard]] std::span<const std::uint16_t> memory() const { return memory_; }

 protected:
  CellBox stored_{};
  FieldLayout layout_{};
  Buffer buffer_;
  std::span<std::uint16_t> memory_;
};

/// In strips where the backend is the CPU, else in rows of `max_cells` at most.
std::unique_ptr<FieldStore> make_field_store(Backend& backend, std::uint16_t cap, std::uint64_t max_cells);

/// The end of such a sentence where the option map.max_megacells is the bound.
std::string limit_of_option(std::uint64_t max_cells);

}  // namespace gdtslam
