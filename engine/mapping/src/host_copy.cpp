#include "host_copy.hpp"

#include <algorithm>
#include <utility>

#include "gdtslam/compute/host_kernels.hpp"
#include "gdtslam/compute/kernels/jump_flood.hpp"

namespace gdtslam {

GlobalField::HostCopy::HostCopy(std::uint32_t radius_cells, DistanceTransform transform)
    : radius_(radius_cells), transform_(transform), table_(distance_table(radius_cells)) {}

const std::vector<std::uint16_t>& GlobalField::HostCopy::cells(const CellBox& box, Isa isa) {
  grow(box);
  for (; !journal_.empty(); journal_.pop_front(), ++held_) merge(journal_.front(), isa);
  return cells_;
}

void GlobalField::HostCopy::adopt(const CellBox& box, std::vector<std::uint16_t> cells, std::uint64_t keyframes) {
  if (keyframes <= held_) return;
  for (; held_ < keyframes; ++held_) journal_.pop_front();
  box_ = box;
  cells_ = std::move(cells);
}

void GlobalField::HostCopy::grow(const CellBox& box) {
  if (box == box_) return;
  const std::uint32_t stride = grid_stride(static_cast<std::uint32_t>(box.width()));
  std::vector<std::uint16_t> fresh(std::size_t{stride} * static_cast<std::size_t>(box.height()), field_cap(radius_));
  const std::size_t old_stride = grid_stride(static_cast<std::uint32_t>(box_.width()));
  const CellOffset shift = box_.min - box.min;
  for (std::int32_t row = 0; row < box_.height(); ++row) {
    const std::size_t to = static_cast<std::size_t>(shift.dy + row) * stride + static_cast<std::size_t>(shift.dx);
    std::copy_n(cells_.data() + static_cast<std::size_t>(row) * old_stride, box_.width(), fresh.data() + to);
  }
  cells_ = std::move(fresh);
  box_ = box;
}

void GlobalField::HostCopy::transform(const EdtColumns::Params& grid, Isa isa) {
  if (transform_ == DistanceTransform::kExact) {
    column_distance_.resize(seeds_.size());
    edt_host(isa, grid, seeds_.data(), column_distance_.data(), squared_distance_.data());
    return;
  }
  for (std::vector<std::uint32_t>& nearest : nearest_) nearest.resize(seeds_.size());
  jump_flood_host(isa, {.width = grid.width, .height = grid.height, .stride = grid.stride, .radius = grid.radius},
                  jump_flood_steps_within(grid.radius), seeds_.data(), nearest_[0].data(), nearest_[1].data(),
                  squared_distance_.data());
}

void GlobalField::HostCopy::merge(const Entry& entry, Isa isa) {
  const CellBox& window = entry.keyframe.window;
  const auto width = static_cast<std::uint32_t>(window.width());
  const auto height = static_cast<std::uint32_t>(window.height());
  const std::uint32_t stride = grid_stride(width);
  const std::size_t count = std::size_t{stride} * height;
  seeds_.assign(count, 0);
  squared_distance_.resize(count);
  field_.resize(count);
  for (const std::uint32_t cell : entry.keyframe.cells) {
    seeds_[std::size_t{cell >> 16U} * stride + (cell & 0xFFFFU)] = 1;
  }
  transform({.width = width, .height = height, .stride = stride, .radius = radius_}, isa);
  const auto table_size = static_cast<std::uint32_t>(table_.size());
  distance_field_host(isa, {.width = width, .height = height, .stride = stride, .table_size = table_size},
                      squared_distance_.data(), table_.data(), field_.data());
  const CellOffset offset = window.min - box_.min;
  gdt_merge_host(isa,
                 {.scan_width = width,
                  .scan_height = height,
                  .scan_stride = stride,
                  .global_stride = grid_stride(static_cast<std::uint32_t>(box_.width())),
                  .offset_x = static_cast<std::uint32_t>(offset.dx),
                  .offset_y = static_cast<std::uint32_t>(offset.dy),
                  .threshold = entry.step.threshold,
                  .lift = entry.step.lift,
                  .cap = field_cap(radius_),
                  .rule = entry.step.rule},
                 cells_.data(), field_.data());
}

}  // namespace gdtslam
