#include "gdtslam/mapping/local_field.hpp"

#include <cassert>

#include "gdtslam/compute/kernels/distance_field.hpp"
#include "gdtslam/compute/kernels/edt.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {

LocalField::LocalField(Backend& backend, std::uint32_t radius_cells) : backend_(&backend), radius_(radius_cells) {
  const std::vector<std::uint16_t> table = distance_table(radius_cells);
  table_size_ = static_cast<std::uint32_t>(table.size());
  table_ = backend_->allocate(table.size() * sizeof(std::uint16_t));
  backend_->upload(table_, std::as_bytes(std::span(table)));
}

void LocalField::reserve(std::uint32_t width, std::uint32_t height) {
  stride_ = grid_stride(width);
  const std::size_t cells = std::size_t{stride_} * height;
  seeds_.assign(cells, 0);
  if (cells <= capacity_) return;
  capacity_ = cells + cells / 4;
  seed_buffer_ = backend_->allocate(capacity_);
  column_distance_ = backend_->allocate(capacity_);
  squared_distance_ = backend_->allocate(capacity_ * sizeof(std::uint16_t));
  field_ = backend_->allocate(capacity_ * sizeof(std::uint16_t));
}

void LocalField::compute(const std::vector<Point2>& points_map_m, double resolution_m, const CellBox& window) {
  window_ = window;
  const auto width = static_cast<std::uint32_t>(window.width());
  const auto height = static_cast<std::uint32_t>(window.height());
  reserve(width, height);
  for (const Point2& p : points_map_m) {
    const CellIndex cell = map_cell_of(p, resolution_m);
    assert(window.contains(cell));
    const CellOffset d = cell - window.min;
    seeds_[static_cast<std::size_t>(d.dy) * stride_ + static_cast<std::size_t>(d.dx)] = 1;
  }
  backend_->upload(seed_buffer_, std::as_bytes(std::span(seeds_)));

  const EdtColumns::Params grid{.width = width, .height = height, .stride = stride_, .radius = radius_};
  run<EdtColumns>(*backend_, grid, {width, 1, 1}, seed_buffer_, column_distance_);
  run<EdtRows>(*backend_, grid, {1, height, 1}, column_distance_, squared_distance_);
  run<DistanceField>(*backend_, {.width = width, .height = height, .stride = stride_, .table_size = table_size_},
                     {width, height, 1}, squared_distance_, table_, field_);
}

void LocalField::merge_into(GlobalField& map, MergeRule rule, std::uint32_t threshold, std::uint32_t lift) {
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
                 .threshold = threshold,
                 .lift = lift,
                 .cap = map.cap(),
                 .rule = rule},
                {width, height, 1}, map.buffer(), field_);
}

}  // namespace gdtslam
