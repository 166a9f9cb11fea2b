#include "local_field.hpp"

#include <cassert>
#include <span>
#include <utility>
#include <vector>

#include "device_memory.hpp"
#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"

namespace gdtslam {
namespace {

template <class T>
void upload_to(Backend& backend, Buffer& buffer, const std::vector<T>& values) {
  reserve_on(backend, buffer, values.size() * sizeof(T));
  backend.upload(buffer, std::as_bytes(std::span(values)));
}

}  // namespace

LocalField::LocalField(Backend& backend, std::uint32_t radius_cells, DistanceTransform transform)
    : backend_(&backend), radius_(radius_cells), transform_(transform), lists_(radius_cells) {
  upload_to(backend, values_,
            transform_ == DistanceTransform::kExact ? stamp_disc(radius_cells) : distance_table(radius_cells));
}

void LocalField::prepare(const KeyframeCells& keyframe, const GlobalField& map) {
  if (transform_ == DistanceTransform::kJumpFlood) {
    map.require_room({&keyframe.window, 1});
    return flood(keyframe);
  }
  lists_.list(keyframe, map);
  map.require_room(lists_.boxes());
  upload_to(*backend_, cells_, lists_.words());
}

void LocalField::reserve(std::size_t cells) {
  reserve_on(*backend_, seeds_, cells);
  for (Buffer& nearest : nearest_) reserve_on(*backend_, nearest, cells * sizeof(std::uint32_t));
  reserve_on(*backend_, squared_distance_, cells * sizeof(std::uint16_t));
  reserve_on(*backend_, field_, cells * sizeof(std::uint16_t));
}

// The field of the keyframe's window by jump flooding.
void LocalField::flood(const KeyframeCells& keyframe) {
  window_ = keyframe.window;
  const auto width = static_cast<std::uint32_t>(window_.width());
  const auto height = static_cast<std::uint32_t>(window_.height());
  const Extent all{width, height, 1};
  stride_ = grid_stride(width);
  reserve(std::size_t{stride_} * height);
  upload_to(*backend_, cells_, keyframe.cells);
  backend_->fill(seeds_, 0);
  const auto count = static_cast<std::uint32_t>(keyframe.cells.size());
  run<SeedScatter>(*backend_, {.count = count, .width = width, .height = height, .stride = stride_}, {count, 1, 1},
                   cells_, seeds_);
  run<JumpFloodInit>(*backend_, {.width = width, .height = height, .stride = stride_}, all, seeds_, nearest_[0]);
  for (const std::uint32_t step : jump_flood_steps_within(radius_)) {
    run<JumpFloodStep>(*backend_, {.width = width, .height = height, .stride = stride_, .step = step}, all, nearest_[0],
                       nearest_[1]);
    std::swap(nearest_[0], nearest_[1]);
  }
  run<JumpFloodDistance>(*backend_, {.width = width, .height = height, .stride = stride_, .radius = radius_}, all,
                         nearest_[0], squared_distance_);
  const std::uint32_t table_size = radius_ * radius_ + 1;  // entries of distance_table()
  run<DistanceField>(*backend_, {.width = width, .height = height, .stride = stride_, .table_size = table_size}, all,
                     squared_distance_, values_, field_);
}

void LocalField::stamp_into(GlobalField& map, const MergeStep& step) {
  const std::uint32_t tiles = lists_.tile_count();
  for (const CellBox& box : lists_.boxes()) map.touch(box);
  run<GdtStamp>(*backend_,
                {.tile_count = tiles,
                 .words = static_cast<std::uint32_t>(lists_.words().size()),
                 .most_obstacles = lists_.most_obstacles(),
                 .stride = map.layout().stride,
                 .radius = radius_,
                 .threshold = step.threshold,
                 .lift = step.lift,
                 .cap = map.cap(),
                 .rule = step.rule,
                 .strip = map.layout().strip,
                 .blank = map.layout().blank},
                {tiles, 1, 1}, map.buffer(), cells_, values_);
}

void LocalField::merge_into(GlobalField& map, const MergeStep& step) {
  if (transform_ == DistanceTransform::kExact) return stamp_into(map, step);
  map.touch(window_);
  const CellOffset offset = window_.min - map.stored().min;
  assert(offset.dx >= 0 && offset.dy >= 0);
  const auto width = static_cast<std::uint32_t>(window_.width());
  const auto height = static_cast<std::uint32_t>(window_.height());
  run<GdtMerge>(*backend_,
                {.scan_width = width,
                 .scan_height = height,
                 .scan_stride = stride_,
                 .global_stride = map.layout().stride,
                 .offset_x = static_cast<std::uint32_t>(offset.dx),
                 .offset_y = static_cast<std::uint32_t>(offset.dy),
                 .threshold = step.threshold,
                 .lift = step.lift,
                 .cap = map.cap(),
                 .rule = step.rule,
                 .global_strip = map.layout().strip,
                 .blank = map.layout().blank},
                {width, height, 1}, map.buffer(), field_);
}

}  // namespace gdtslam
