#include "field_rows.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "gdtslam/core/error.hpp"
#include "growth.hpp"

namespace gdtslam {
namespace {

std::uint64_t cells_in_rows(const CellBox& box) {
  return std::uint64_t{row_stride(box)} * static_cast<std::uint64_t>(box.height());
}

// Cells as those of another box; the cap where the first has none.
std::vector<std::uint16_t> moved_cells(const CellRows& from, const CellBox& to, std::size_t stride, std::uint16_t cap) {
  std::vector<std::uint16_t> moved(stride * static_cast<std::size_t>(to.height()), cap);
  const CellBox kept = common_part(from.box, to);
  for (std::int32_t y = kept.min.y; y < kept.end.y && !kept.empty(); ++y) {
    const auto place = [&kept, y](const CellBox& box, std::size_t row) {
      return static_cast<std::size_t>(y - box.min.y) * row + static_cast<std::size_t>(kept.min.x - box.min.x);
    };
    std::copy_n(from.cells.data() + place(from.box, from.stride), kept.width(), moved.data() + place(to, stride));
  }
  return moved;
}

}  // namespace

std::uint32_t row_stride(const CellBox& box) { return grid_stride(static_cast<std::uint32_t>(box.width())); }

bool FieldRows::can_hold(const CellBox& box) const {
  return std::min(box.min.x, box.min.y) >= -kFurthestCell && std::max(box.end.x, box.end.y) <= kFurthestCell &&
         cells_in_rows(box) <= max_cells_;
}

// If the map has outgrown the device, the error says so, and what to change.
Buffer FieldRows::allocate_for(const CellBox& box) const {
  const std::size_t bytes = cells_in_rows(box) * sizeof(std::uint16_t);
  try {
    return backend_->allocate(bytes);
  } catch (const DeviceError& error) {
    const DeviceInfo& device = backend_->device();
    if (bytes <= device.max_buffer_bytes) throw;
    throw DeviceError(
        device.name, error.call(),
        error.result() + ", for the map of " + size_text(box) + "; a larger map.resolution makes it smaller");
  }
}

void FieldRows::hold(const GridBoxes& boxes) {
  const CellBox& box = boxes.stored;
  if (box == stored_) return;
  Buffer buffer = allocate_for(box);
  if (stored_.empty()) {
    backend_->fill(buffer, std::uint32_t{cap_} << 16U | cap_);
  } else if (bounding_box(box, stored_) == box) {
    copy_into(buffer, box);
  } else {
    // A margin was given up, which happens a few times at most: by way of the host.
    const std::vector<std::uint16_t> cells = read();
    const CellRows from{cells, static_cast<std::size_t>(stored_.width()), stored_};
    const std::vector<std::uint16_t> moved = moved_cells(from, box, row_stride(box), cap_);
    backend_->upload(buffer, std::as_bytes(std::span(moved)));
  }
  buffer_ = std::move(buffer);
  stored_ = box;
  layout_.stride = row_stride(box);
}

// The field in a buffer for a box that holds all of it.
void FieldRows::copy_into(const Buffer& target, const CellBox& box) const {
  const CellOffset offset = stored_.min - box.min;
  const auto width = static_cast<std::uint32_t>(box.width());
  const auto height = static_cast<std::uint32_t>(box.height());
  run<FieldGrow>(*backend_,
                 {.old_width = static_cast<std::uint32_t>(stored_.width()),
                  .old_height = static_cast<std::uint32_t>(stored_.height()),
                  .old_stride = layout_.stride,
                  .width = width,
                  .height = height,
                  .stride = row_stride(box),
                  .offset_x = static_cast<std::uint32_t>(offset.dx),
                  .offset_y = static_cast<std::uint32_t>(offset.dy),
                  .cap = cap_},
                 {width, height, 1}, buffer_, target);
}

std::uint64_t FieldRows::taken_cells() const { return stored_.empty() ? 0 : cells_in_rows(stored_); }

std::vector<std::uint16_t> FieldRows::read() const {
  std::vector<std::uint16_t> cells(taken_cells());
  if (cells.empty()) return cells;
  backend_->download(buffer_, std::as_writable_bytes(std::span(cells)));
  return moved_cells({cells, layout_.stride, stored_}, stored_, static_cast<std::size_t>(stored_.width()), cap_);
}

void FieldRows::write(const CellRows& from) {
  const std::vector<std::uint16_t> moved = moved_cells(from, stored_, layout_.stride, cap_);
  backend_->upload(buffer_, std::as_bytes(std::span(moved)));
}

}  // namespace gdtslam
