#include "gdtslam/mapping/global_field.hpp"

#include <algorithm>
#include <cassert>
#include <string>
#include <vector>

#include "gdtslam/compute/kernels/distance_field.hpp"
#include "gdtslam/compute/kernels/edt.hpp"
#include "gdtslam/core/error.hpp"
#include "growth.hpp"

namespace gdtslam {
namespace {

constexpr std::int32_t kGuardCells = 2;  // the outermost rows and columns that always hold the cap
constexpr std::int64_t kFurthestCell = 1 << 30;

std::uint64_t cells_of(const CellBox& box) {
  return std::uint64_t{grid_stride(static_cast<std::uint32_t>(box.width()))} * static_cast<std::uint64_t>(box.height());
}

}  // namespace

GlobalField::GlobalField(Backend& backend, double resolution_m, std::uint32_t radius_cells, std::uint64_t max_cells)
    : backend_(&backend), resolution_m_(resolution_m), radius_(radius_cells), max_cells_(max_cells) {}

GridGeometry GlobalField::geometry() const {
  return {.resolution_m = resolution_m_,
          .origin_x_m = first_.x * resolution_m_,
          .origin_y_m = first_.y * resolution_m_,
          .width = static_cast<std::int32_t>(width_),
          .height = static_cast<std::int32_t>(height_)};
}

std::uint16_t GlobalField::cap() const { return field_cap(radius_); }

std::span<const std::uint16_t> GlobalField::cells() const {
  if (!buffer_.valid()) return {};
  const std::span<std::byte> bytes = backend_->host_view(buffer_);
  // The bytes were written as uint16 by upload and by the kernels, aligned by the backend.
  return {reinterpret_cast<const std::uint16_t*>(bytes.data()), bytes.size() / sizeof(std::uint16_t)};
}

std::uint16_t GlobalField::at(CellIndex map_cell) const {
  const CellOffset d = map_cell - first_;
  if (d.dx < 0 || d.dy < 0 || d.dx >= static_cast<std::int32_t>(width_) || d.dy >= static_cast<std::int32_t>(height_)) {
    return cap();
  }
  return cells()[static_cast<std::size_t>(d.dy) * stride_ + static_cast<std::size_t>(d.dx)];
}

void GlobalField::grow_to_hold(const CellBox& map_box) {
  assert(!map_box.empty());
  const CellBox guarded{map_box.min - CellOffset{kGuardCells, kGuardCells},
                        map_box.end + CellOffset{kGuardCells, kGuardCells}};
  const CellBox stored{first_,
                       first_ + CellOffset{static_cast<std::int32_t>(width_), static_cast<std::int32_t>(height_)}};
  const CellBox needed = hull_of(stored, guarded);
  if (needed == stored) return;
  if (std::min(needed.min.x, needed.min.y) < -kFurthestCell || std::max(needed.end.x, needed.end.y) > kFurthestCell ||
      cells_of(needed) > max_cells_) {
    throw InputError("the map would need " + std::to_string(needed.width()) + " x " + std::to_string(needed.height()) +
                     " cells, more than map.max_megacells allows (" + std::to_string(max_cells_ >> 20U) +
                     " x 2^20); check the log with 'gdtslam doctor' or raise the limit");
  }
  CellBox grown = with_margin(stored, needed);
  if (cells_of(grown) > max_cells_) grown = needed;

  const auto width = static_cast<std::uint32_t>(grown.width());
  const auto height = static_cast<std::uint32_t>(grown.height());
  const std::uint32_t stride = grid_stride(width);
  std::vector<std::uint16_t> fresh(std::size_t{stride} * height, cap());
  const std::span<const std::uint16_t> old = cells();
  const CellOffset shift = first_ - grown.min;
  for (std::uint32_t row = 0; row < height_; ++row) {
    const std::size_t to = (static_cast<std::size_t>(shift.dy) + row) * stride + static_cast<std::size_t>(shift.dx);
    std::copy_n(old.data() + std::size_t{row} * stride_, width_, fresh.data() + to);
  }
  Buffer buffer = backend_->allocate(fresh.size() * sizeof(std::uint16_t));
  backend_->upload(buffer, std::as_bytes(std::span(fresh)));
  buffer_ = std::move(buffer);
  first_ = grown.min;
  width_ = width;
  height_ = height;
  stride_ = stride;
}

}  // namespace gdtslam
