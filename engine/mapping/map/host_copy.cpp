#include "host_copy.hpp"

#include <algorithm>
#include <utility>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/edt/edt.hpp"
#include "engine/compute/kernels/host_kernels.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "growth.hpp"

namespace gdtslam {

GlobalField::HostCopy::HostCopy(std::uint32_t radius_cells, DistanceTransform transform)
    : radius_(radius_cells), transform_(transform), table_(distance_table(radius_cells)) {}

const std::vector<std::uint16_t>& GlobalField::HostCopy::cells(const CellBox& box, Isa isa) {
  if (box != box_) cells_ = moved_cells(cells_, box_, box, field_cap(radius_));
  box_ = box;
  for (; !journal_.empty(); journal_.pop_front(), ++held_) merge(journal_.front(), isa);
  return cells_;
}

void GlobalField::HostCopy::adopt(const CellBox& box, std::vector<std::uint16_t> cells, std::uint64_t keyframes) {
  if (keyframes <= held_) return;
  for (; held_ < keyframes; ++held_) journal_.pop_front();
  box_ = box;
  cells_ = std::move(cells);
}

std::vector<std::uint16_t> moved_cells(const std::vector<std::uint16_t>& cells, const CellBox& from, const CellBox& to,
                                       std::uint16_t cap) {
  const std::size_t from_stride = grid_stride(static_cast<std::uint32_t>(from.width()));
  const std::size_t to_stride = grid_stride(static_cast<std::uint32_t>(to.width()));
  std::vector<std::uint16_t> moved(to_stride * static_cast<std::size_t>(to.height()), cap);
  const CellBox kept = common_part(from, to);
  if (kept.empty()) return moved;
  const auto place = [&kept](const CellBox& box, std::size_t stride, std::int32_t y) {
    return static_cast<std::size_t>(y - box.min.y) * stride + static_cast<std::size_t>(kept.min.x - box.min.x);
  };
  for (std::int32_t y = kept.min.y; y < kept.end.y; ++y) {
    std::copy_n(cells.data() + place(from, from_stride, y), kept.width(), moved.data() + place(to, to_stride, y));
  }
  return moved;
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
