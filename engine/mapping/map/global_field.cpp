#include "gdtslam/mapping/global_field.hpp"

#include <algorithm>
#include <cassert>
#include <string>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/edt/edt.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "gdtslam/core/error.hpp"
#include "growth.hpp"
#include "host_copy.hpp"

namespace gdtslam {
namespace {

constexpr std::int32_t kGuardCells = 2;  // the outermost rows and columns that always hold the cap
constexpr std::int64_t kFurthestCell = 1 << 30;
constexpr std::size_t kLongJournal = 64;  // keyframes: a moment's work to replay
constexpr std::size_t kPieceBytes = std::size_t{1} << 20U;

std::uint32_t stride_of(const CellBox& box) { return grid_stride(static_cast<std::uint32_t>(box.width())); }

std::uint64_t cells_of(const CellBox& box) {
  return std::uint64_t{stride_of(box)} * static_cast<std::uint64_t>(box.height());
}

// What a device leaves between the rows is its own affair.
void blank_padding(std::vector<std::uint16_t>& cells, const CellBox& box, std::uint16_t value) {
  const std::size_t stride = stride_of(box);
  for (std::size_t row = 0; row < static_cast<std::size_t>(box.height()); ++row) {
    std::fill(cells.begin() + static_cast<std::ptrdiff_t>(row * stride + static_cast<std::size_t>(box.width())),
              cells.begin() + static_cast<std::ptrdiff_t>((row + 1) * stride), value);
  }
}

}  // namespace

GlobalField::GlobalField(Backend& backend, double resolution_m, std::uint32_t radius_cells, std::uint64_t max_cells,
                         DistanceTransform transform)
    : backend_(&backend),
      isa_(backend.host_isa()),
      resolution_m_(resolution_m),
      radius_(radius_cells),
      max_cells_(max_cells),
      transform_(transform),
      copy_(std::make_unique<HostCopy>(radius_cells, transform)) {}

GlobalField::~GlobalField() = default;

GridGeometry GlobalField::geometry() const {
  return {.resolution_m = resolution_m_,
          .origin_x_m = box_.min.x * resolution_m_,
          .origin_y_m = box_.min.y * resolution_m_,
          .width = box_.width(),
          .height = box_.height()};
}

std::uint16_t GlobalField::cap() const { return field_cap(radius_); }

std::span<const std::uint16_t> GlobalField::cells() const {
  if (shares_memory()) return shared_;
  if (box_.empty()) return {};
  return copy_->cells(box_, isa_);
}

std::uint16_t GlobalField::at(CellIndex map_cell) const {
  if (!box_.contains(map_cell)) return cap();
  const CellOffset d = map_cell - box_.min;
  return cells()[static_cast<std::size_t>(d.dy) * stride_ + static_cast<std::size_t>(d.dx)];
}

void GlobalField::grow_to_hold(const CellBox& map_box) {
  resize_to_hold(map_box);
  resize_buffer();
}

void GlobalField::add_keyframe(const KeyframeCells& keyframe, const MergeStep& step) {
  resize_to_hold(keyframe.window);
  if (!shares_memory()) copy_->note(keyframe, step);
  resize_buffer();
}

void GlobalField::resize_to_hold(const CellBox& map_box) {
  assert(!map_box.empty());
  const CellBox guarded{map_box.min - CellOffset{kGuardCells, kGuardCells},
                        map_box.end + CellOffset{kGuardCells, kGuardCells}};
  const CellBox content = hull_of(content_, guarded);
  const auto fits = [this](const CellBox& box) {
    return std::min(box.min.x, box.min.y) >= -kFurthestCell && std::max(box.end.x, box.end.y) <= kFurthestCell &&
           cells_of(box) <= max_cells_;
  };
  const std::optional<GridBoxes> grown = grown_to_hold({content_, box_}, guarded, fits);
  if (!grown) {
    throw InputError("the map would need " + std::to_string(content.width()) + " x " +
                     std::to_string(content.height()) + " cells, more than map.max_megacells allows (" +
                     std::to_string(max_cells_ >> 20U) +
                     " x 2^20); check the log with 'gdtslam doctor' or raise the limit");
  }
  content_ = grown->content;
  box_ = grown->stored;
  stride_ = stride_of(box_);
}

void GlobalField::resize_buffer() {
  if (backend_ == nullptr || buffer_box_ == box_) return;
  Buffer buffer = backend_->allocate(cells_of(box_) * sizeof(std::uint16_t));
  if (buffer_box_.empty()) {
    backend_->fill(buffer, std::uint32_t{cap()} << 16U | cap());
  } else if (hull_of(box_, buffer_box_) == box_) {
    copy_field(buffer);
  } else {
    // A margin was given up, which happens a few times at most: by way of the host.
    const std::vector<std::uint16_t> cells = moved_cells(download_device_cells(), buffer_box_, box_, cap());
    backend_->upload(buffer, std::as_bytes(std::span(cells)));
  }
  buffer_ = std::move(buffer);
  buffer_box_ = box_;
  look_for_shared_memory();
}

// The field as it lies in the buffer to one of the present size.
void GlobalField::copy_field(const Buffer& target) const {
  const CellOffset offset = buffer_box_.min - box_.min;
  const auto width = static_cast<std::uint32_t>(box_.width());
  const auto height = static_cast<std::uint32_t>(box_.height());
  run<FieldGrow>(*backend_,
                 {.old_width = static_cast<std::uint32_t>(buffer_box_.width()),
                  .old_height = static_cast<std::uint32_t>(buffer_box_.height()),
                  .old_stride = stride_of(buffer_box_),
                  .width = width,
                  .height = height,
                  .stride = stride_,
                  .offset_x = static_cast<std::uint32_t>(offset.dx),
                  .offset_y = static_cast<std::uint32_t>(offset.dy),
                  .cap = cap()},
                 {width, height, 1}, buffer_, target);
}

void GlobalField::look_for_shared_memory() {
  const std::span<const std::byte> view = backend_->host_view(buffer_);
  // The bytes are written as uint16 by the kernels, aligned by the backend.
  shared_ = {reinterpret_cast<const std::uint16_t*>(view.data()), view.size() / sizeof(std::uint16_t)};
  if (shares_memory()) copy_ = std::make_unique<HostCopy>(radius_, transform_);
}

std::size_t GlobalField::journal_length() const { return copy_->journal_length(); }

void GlobalField::start_checkpoint() {
  Checkpoint begun;
  begun.snapshot = backend_->allocate(cells_of(box_) * sizeof(std::uint16_t));
  begun.box = box_;
  begun.keyframes = copy_->keyframes();
  begun.cells.resize(cells_of(box_));
  copy_field(begun.snapshot);
  checkpoint_ = std::move(begun);
}

void GlobalField::continue_checkpoint() {
  if (backend_ == nullptr || shares_memory()) return;
  if (!checkpoint_ && copy_->journal_length() >= kLongJournal) start_checkpoint();
  if (!checkpoint_ || checkpoint_->under_way) return;
  Checkpoint& c = *checkpoint_;
  const std::size_t bytes = std::min(kPieceBytes, (c.cells.size() - c.arrived) * sizeof(std::uint16_t));
  c.under_way = backend_->start_download(c.snapshot, bytes, c.arrived * sizeof(std::uint16_t));
}

void GlobalField::take_checkpoint_piece() {
  if (!checkpoint_ || !checkpoint_->under_way) return;
  Checkpoint& c = *checkpoint_;
  const PendingDownload piece = *c.under_way;
  c.under_way.reset();
  const std::size_t cells = piece.bytes / sizeof(std::uint16_t);
  backend_->finish_download(piece, std::as_writable_bytes(std::span(c.cells).subspan(c.arrived, cells)));
  c.arrived += cells;
  if (c.arrived < c.cells.size()) return;
  blank_padding(c.cells, c.box, cap());
  copy_->adopt(c.box, std::move(c.cells), c.keyframes);
  checkpoint_.reset();
}

std::vector<std::uint16_t> GlobalField::download_device_cells() {
  std::vector<std::uint16_t> cells(cells_of(buffer_box_));
  if (cells.empty()) return cells;
  backend_->download(buffer_, std::as_writable_bytes(std::span(cells)));
  blank_padding(cells, buffer_box_, cap());
  return cells;
}

void GlobalField::move_to(Backend& backend) {
  const std::span<const std::uint16_t> known = cells();
  Buffer buffer;
  if (!known.empty()) {
    buffer = backend.allocate(known.size_bytes());
    backend.upload(buffer, std::as_bytes(known));
  }
  leave_device();
  backend_ = &backend;
  isa_ = backend.host_isa();
  buffer_ = std::move(buffer);
  buffer_box_ = box_;
  if (!box_.empty()) look_for_shared_memory();
}

void GlobalField::leave_device() {
  checkpoint_.reset();
  shared_ = {};
  buffer_ = Buffer();
  buffer_box_ = {};
  backend_ = nullptr;
}

}  // namespace gdtslam
