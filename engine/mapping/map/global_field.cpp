#include "gdtslam/mapping/global_field.hpp"

#include <cassert>
#include <string>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "gdtslam/core/error.hpp"
#include "store/field_store.hpp"
#include "store/growth.hpp"

namespace gdtslam {
namespace {

constexpr std::int32_t kGuardCells = 2;  // the outermost rows and columns that always hold the cap

}  // namespace

GlobalField::GlobalField(Backend& backend, double resolution_m, std::uint32_t radius_cells, std::uint64_t max_cells)
    : backend_(&backend),
      resolution_m_(resolution_m),
      radius_(radius_cells),
      max_cells_(max_cells),
      store_(make_field_store(backend, field_cap(radius_cells), max_cells)) {}
GlobalField::~GlobalField() = default;

GridGeometry GlobalField::geometry() const {
  return {.resolution_m = resolution_m_,
          .origin_x_m = box_.min.x * resolution_m_,
          .origin_y_m = box_.min.y * resolution_m_,
          .width = box_.width(),
          .height = box_.height()};
}

std::uint16_t GlobalField::cap() const { return field_cap(radius_); }
std::uint64_t GlobalField::taken_cells() const { return store_->taken_cells(); }
const CellBox& GlobalField::stored() const { return store_->stored(); }
const FieldLayout& GlobalField::layout() const { return store_->layout(); }
const Buffer& GlobalField::buffer() const { return store_->buffer(); }
std::span<const std::uint16_t> GlobalField::memory() const { return store_->memory(); }

std::uint16_t GlobalField::at(CellIndex map_cell) const { return at_and_beside(map_cell).front(); }

std::array<std::uint16_t, 4> GlobalField::at_and_beside(CellIndex map_cell) const {
  const CellBox& stored = store_->stored();
  const bool is_inside = map_cell.x >= stored.min.x && map_cell.y >= stored.min.y && map_cell.x + 1 < stored.end.x &&
                         map_cell.y + 1 < stored.end.y;
  if (!is_inside) return {cap(), cap(), cap(), cap()};  // cells outside are unknown
  const FieldLayout& layout = store_->layout();
  const CellOffset d = map_cell - stored.min;
  const std::size_t place = layout.place(static_cast<std::size_t>(d.dx), static_cast<std::size_t>(d.dy));
  const auto cells = store_->memory().subspan(place, layout.stride + 2);
  const auto value = [&](std::size_t i) { return static_cast<std::uint16_t>(cells[i] ^ layout.blank); };
  return {value(0), value(1), value(layout.stride), value(layout.stride + 1)};
}

void GlobalField::read_row(CellIndex first, std::span<std::uint16_t> cells) const {
  store_->read_row(first, cells, cap());
}

void GlobalField::grow_to_hold(const CellBox& map_box) {
  assert(!map_box.empty());
  const CellBox guarded{map_box.min - CellOffset{kGuardCells, kGuardCells},
                        map_box.end + CellOffset{kGuardCells, kGuardCells}};
  const auto fits = [this](const CellBox& box) { return store_->can_hold(box); };
  const std::optional<GridBoxes> grown = grown_to_hold({content_, box_}, guarded, fits);
  if (!grown) {
    throw InputError("the map would reach over " + size_text(bounding_box(content_, guarded)) + store_->limit());
  }
  store_->hold(*grown);
  box_ = grown->stored;
  content_ = grown->content;
}

void GlobalField::require_room(std::span<const CellBox> map_boxes) const {
  std::uint64_t cells = store_->taken_cells();
  for (const CellBox& box : map_boxes) cells += store_->untaken_cells(box);
  if (cells > max_cells_) {
    throw InputError("the map would need " + std::to_string(cells) + " known cells" + limit_of_option(max_cells_));
  }
}

void GlobalField::touch(const CellBox& map_box) { store_->touch(map_box); }

std::vector<std::uint16_t> GlobalField::download() const { return store_->read(); }
void GlobalField::adopt(const CellRows& from) { store_->write(from); }

DistanceFieldRows rows_of(const GlobalField& field) {
  return {field.geometry(), field.cap(), [&field](std::int32_t y, std::span<std::uint16_t> row) {
            field.read_row(field.box().min + CellOffset{0, y}, row);
          }};
}

}  // namespace gdtslam
