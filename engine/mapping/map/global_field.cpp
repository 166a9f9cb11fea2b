#include "gdtslam/mapping/global_field.hpp"

#include <algorithm>
#include <cassert>
#include <string>
#include <utility>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/edt/edt.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "gdtslam/core/error.hpp"
#include "growth.hpp"

namespace gdtslam {
namespace {

constexpr std::int32_t kGuardCells = 2;  // the outermost rows and columns that always hold the cap

std::uint32_t stride_for(const CellBox& box) { return grid_stride(static_cast<std::uint32_t>(box.width())); }

std::uint64_t cell_count(const CellBox& box) {
  return std::uint64_t{stride_for(box)} * static_cast<std::uint64_t>(box.height());
}

// The cells of a field of one box as the field of another; the cap where the first has none.
std::vector<std::uint16_t> moved_cells(const std::vector<std::uint16_t>& cells, const CellBox& from, const CellBox& to,
                                       std::uint16_t cap) {
  std::vector<std::uint16_t> moved(cell_count(to), cap);
  const CellBox kept = common_part(from, to);
  if (kept.empty()) return moved;
  const auto place = [&kept](const CellBox& box, std::int32_t y) {
    return static_cast<std::size_t>(y - box.min.y) * stride_for(box) + static_cast<std::size_t>(kept.min.x - box.min.x);
  };
  for (std::int32_t y = kept.min.y; y < kept.end.y; ++y) {
    std::copy_n(cells.data() + place(from, y), kept.width(), moved.data() + place(to, y));
  }
  return moved;
}

}  // namespace

GridGeometry GlobalField::geometry() const {
  return {.resolution_m = resolution_m_,
          .origin_x_m = box_.min.x * resolution_m_,
          .origin_y_m = box_.min.y * resolution_m_,
          .width = box_.width(),
          .height = box_.height()};
}

std::uint16_t GlobalField::cap() const { return field_cap(radius_); }

std::uint16_t GlobalField::at(CellIndex map_cell) const {
  if (!box_.contains(map_cell)) return cap();
  assert(!cells_.empty());
  const CellOffset d = map_cell - box_.min;
  return cells_[static_cast<std::size_t>(d.dy) * stride_ + static_cast<std::size_t>(d.dx)];
}

void GlobalField::grow_to_hold(const CellBox& map_box) {
  assert(!map_box.empty());
  const CellBox guarded{map_box.min - CellOffset{kGuardCells, kGuardCells},
                        map_box.end + CellOffset{kGuardCells, kGuardCells}};
  const auto fits = [this](const CellBox& box) {
    return std::min(box.min.x, box.min.y) >= -kFurthestCell && std::max(box.end.x, box.end.y) <= kFurthestCell &&
           cell_count(box) <= max_cells_;
  };
  const std::optional<GridBoxes> grown = grown_to_hold({content_, box_}, guarded, fits);
  if (!grown) {
    const CellBox content = hull_of(content_, guarded);
    throw InputError("the map would need " + std::to_string(content.width()) + " x " +
                     std::to_string(content.height()) + " cells, more than map.max_megacells allows (" +
                     std::to_string(max_cells_ >> 20U) +
                     " x 2^20); check the log with 'gdtslam doctor' or raise the limit");
  }
  if (grown->stored != box_) move_to(grown->stored);
  content_ = grown->content;
}

// Where the map has outgrown the device, the error says so, and what to change.
Buffer GlobalField::allocate_for(const CellBox& box) const {
  const std::size_t bytes = cell_count(box) * sizeof(std::uint16_t);
  try {
    return backend_->allocate(bytes);
  } catch (const DeviceError& error) {
    const DeviceInfo& device = backend_->device();
    if (bytes <= device.max_buffer_bytes) throw;
    const std::string size = std::to_string(box.width()) + " x " + std::to_string(box.height());
    throw DeviceError(device.name, error.call(),
                      error.result() + ", for the map of " + size +
                          " cells; a larger map.resolution makes it smaller, map.max_megacells=" +
                          std::to_string(device.max_buffer_bytes / sizeof(std::uint16_t) >> 20U) +
                          " bounds it to that");
  }
}

void GlobalField::move_to(const CellBox& box) {
  Buffer buffer = allocate_for(box);
  if (box_.empty()) {
    backend_->fill(buffer, std::uint32_t{cap()} << 16U | cap());
  } else if (hull_of(box, box_) == box) {
    copy_into(buffer, box);
  } else {
    // A margin was given up, which happens a few times at most: by way of the host.
    const std::vector<std::uint16_t> cells = moved_cells(download(), box_, box, cap());
    backend_->upload(buffer, std::as_bytes(std::span(cells)));
  }
  buffer_ = std::move(buffer);
  box_ = box;
  stride_ = stride_for(box_);
  const std::span<const std::byte> view = backend_->host_view(buffer_);
  // The bytes are written as uint16 by the kernels, aligned by the backend.
  cells_ = {reinterpret_cast<const std::uint16_t*>(view.data()), view.size() / sizeof(std::uint16_t)};
}

// The field in a buffer for a box that holds all of it.
void GlobalField::copy_into(const Buffer& target, const CellBox& box) const {
  const CellOffset offset = box_.min - box.min;
  const auto width = static_cast<std::uint32_t>(box.width());
  const auto height = static_cast<std::uint32_t>(box.height());
  run<FieldGrow>(*backend_,
                 {.old_width = static_cast<std::uint32_t>(box_.width()),
                  .old_height = static_cast<std::uint32_t>(box_.height()),
                  .old_stride = stride_,
                  .width = width,
                  .height = height,
                  .stride = stride_for(box),
                  .offset_x = static_cast<std::uint32_t>(offset.dx),
                  .offset_y = static_cast<std::uint32_t>(offset.dy),
                  .cap = cap()},
                 {width, height, 1}, buffer_, target);
}

Buffer GlobalField::snapshot() const {
  Buffer copy = allocate_for(box_);
  copy_into(copy, box_);
  return copy;
}

std::vector<std::uint16_t> GlobalField::download() const {
  std::vector<std::uint16_t> cells(cell_count(box_));
  if (cells.empty()) return cells;
  backend_->download(buffer_, std::as_writable_bytes(std::span(cells)));
  return moved_cells(cells, box_, box_, cap());  // what a device leaves between the rows is its own affair
}

void GlobalField::adopt(const std::vector<std::uint16_t>& cells, const CellBox& box) {
  const std::vector<std::uint16_t> moved = moved_cells(cells, box, box_, cap());
  backend_->upload(buffer_, std::as_bytes(std::span(moved)));
}

}  // namespace gdtslam
