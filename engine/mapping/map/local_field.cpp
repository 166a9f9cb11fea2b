#include "local_field.hpp"

#include <cassert>
#include <utility>
#include <vector>

#include "device_memory.hpp"
#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/edt/edt.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"

namespace gdtslam {

LocalField::LocalField(Backend& backend, std::uint32_t radius_cells, DistanceTransform transform)
    : backend_(&backend), radius_(radius_cells), transform_(transform) {
  const std::vector<std::uint16_t> table = distance_table(radius_cells);
  table_size_ = static_cast<std::uint32_t>(table.size());
  table_ = backend_->allocate(table.size() * sizeof(std::uint16_t));
  backend_->upload(table_, std::as_bytes(std::span(table)));
}

void LocalField::reserve(std::size_t cells) {
  reserve_on(*backend_, seeds_, cells);
  if (transform_ == DistanceTransform::kExact) {
    reserve_on(*backend_, column_distance_, cells);
  } else {
    for (Buffer& nearest : nearest_) reserve_on(*backend_, nearest, cells * sizeof(std::uint32_t));
  }
  reserve_on(*backend_, squared_distance_, cells * sizeof(std::uint16_t));
  reserve_on(*backend_, field_, cells * sizeof(std::uint16_t));
}

void LocalField::compute(const KeyframeCells& keyframe) {
  window_ = keyframe.window;
  const auto width = static_cast<std::uint32_t>(window_.width());
  const auto height = static_cast<std::uint32_t>(window_.height());
  stride_ = grid_stride(width);
  reserve(std::size_t{stride_} * height);
  reserve_on(*backend_, cells_, keyframe.cells.size() * sizeof(std::uint32_t));

  backend_->upload(cells_, std::as_bytes(std::span(keyframe.cells)));
  backend_->fill(seeds_, 0);
  const auto count = static_cast<std::uint32_t>(keyframe.cells.size());
  run<SeedScatter>(*backend_, {.count = count, .width = width, .height = height, .stride = stride_}, {count, 1, 1},
                   cells_, seeds_);
  transform_ == DistanceTransform::kExact ? transform_exactly() : flood();
  run<DistanceField>(*backend_, {.width = width, .height = height, .stride = stride_, .table_size = table_size_},
                     {width, height, 1}, squared_distance_, table_, field_);
}

void LocalField::transform_exactly() {
  const auto width = static_cast<std::uint32_t>(window_.width());
  const auto height = static_cast<std::uint32_t>(window_.height());
  const EdtColumns::Params grid{.width = width, .height = height, .stride = stride_, .radius = radius_};
  run<EdtColumns>(*backend_, grid, {width, 1, 1}, seeds_, column_distance_);
  run<EdtRows>(*backend_, grid, {1, height, 1}, column_distance_, squared_distance_);
}

void LocalField::flood() {
  const auto width = static_cast<std::uint32_t>(window_.width());
  const auto height = static_cast<std::uint32_t>(window_.height());
  const Extent all{width, height, 1};
  run<JumpFloodInit>(*backend_, {.width = width, .height = height, .stride = stride_}, all, seeds_, nearest_[0]);
  for (const std::uint32_t step : jump_flood_steps_within(radius_)) {
    run<JumpFloodStep>(*backend_, {.width = width, .height = height, .stride = stride_, .step = step}, all, nearest_[0],
                       nearest_[1]);
    std::swap(nearest_[0], nearest_[1]);
  }
  run<JumpFloodDistance>(*backend_, {.width = width, .height = height, .stride = stride_, .radius = radius_}, all,
                         nearest_[0], squared_distance_);
}

void LocalField::merge_into(GlobalField& map, const MergeStep& step) {
  const CellOffset offset = window_.min - map.first_cell();
  assert(offset.dx >= 0 && offset.dy >= 0);
  const auto width = static_cast<std::uint32_t>(window_.width());
  const auto height = static_cast<std::uint32_t>(window_.height());
  run<GdtMerge>(*backend_,
                {.scan_width = width,
                 .scan_height = height,
                 .scan_stride = stride_,
                 .global_stride = map.stride(),
                 .offset_x = static_cast<std::uint32_t>(offset.dx),
                 .offset_y = static_cast<std::uint32_t>(offset.dy),
                 .threshold = step.threshold,
                 .lift = step.lift,
                 .cap = map.cap(),
                 .rule = step.rule},
                {width, height, 1}, map.buffer(), field_);
}

}  // namespace gdtslam
