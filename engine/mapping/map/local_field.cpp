#include "local_field.hpp"

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>

#include "engine/compute/device_memory.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "store/growth.hpp"

namespace gdtslam {
namespace {

constexpr auto kTile = static_cast<std::int32_t>(kStampTile);

template <class T>
void upload_to(Backend& backend, Buffer& buffer, const std::vector<T>& values) {
  reserve_on(backend, buffer, values.size() * sizeof(T));
  backend.upload(buffer, std::as_bytes(std::span(values)));
}

}  // namespace

// Calls see(tile of reach_, x, y) for each tile that the disc around an obstacle touches; x and y count from the tile's
// lower left cell.
template <class See>
void StampLists::for_each_reached(const KeyframeCells& keyframe, See see) {
  for (const std::uint32_t cell : keyframe.cells) {
    const std::int32_t x = window_.dx + static_cast<std::int32_t>(cell & 0xFFFFU);
    const std::int32_t y = window_.dy + static_cast<std::int32_t>(cell >> 16U);
    for (std::int32_t ty = (y - radius_) / kTile; ty <= (y + radius_) / kTile; ++ty) {
      for (std::int32_t tx = (x - radius_) / kTile; tx <= (x + radius_) / kTile; ++tx) {
        const std::int32_t tile = (ty - reach_.min.y) * reach_.width() + tx - reach_.min.x;
        see(reached_[static_cast<std::size_t>(tile)], x - tx * kTile, y - ty * kTile);
      }
    }
  }
}

void StampLists::list(const KeyframeCells& keyframe, const GlobalField& map) {
  window_ = keyframe.window.min - map.stored().min;
  assert(window_.dx >= 0 && window_.dy >= 0);
  reach_ = {{window_.dx / kTile, window_.dy / kTile},
            {(window_.dx + keyframe.window.width() - 1) / kTile + 1,
             (window_.dy + keyframe.window.height() - 1) / kTile + 1}};
  reached_.assign(static_cast<std::size_t>(reach_.width()) * static_cast<std::size_t>(reach_.height()), {});
  for_each_reached(keyframe, [](Reached& tile, std::int32_t, std::int32_t) { ++tile.count; });
  lay_out(map);
  for_each_reached(keyframe, [this](Reached& tile, std::int32_t x, std::int32_t y) {
    words_[tile.next++] = static_cast<std::uint32_t>(y + radius_) << 16U | static_cast<std::uint32_t>(x + radius_);
  });
  for (const StampTile& tile : tiles_) {
    for (std::uint32_t i = tile.count; i % kStampGroup != 0; ++i) {
      words_[tile.first + i] = words_[tile.first];
    }
  }
}

// Lists the tiles that are reached, and the positions of their obstacles.
void StampLists::lay_out(const GlobalField& map) {
  tiles_.clear();
  boxes_.clear();
  most_ = 0;
  std::uint32_t next = 0;
  auto tile = reached_.begin();
  for (std::int32_t ty = reach_.min.y; ty < reach_.end.y; ++ty) {
    for (std::int32_t tx = reach_.min.x; tx < reach_.end.x; ++tx, ++tile) {
      if (tile->count == 0) continue;
      const CellOffset corner{tx * kTile, ty * kTile};
      const CellIndex first = map.stored().min + corner;
      const CellBox box = common_part({first, first + CellOffset{kTile, kTile}}, map.stored());
      const std::uint32_t size =
          static_cast<std::uint32_t>(box.height()) << 16U | static_cast<std::uint32_t>(box.width());
      const std::size_t base =
          map.layout().place(static_cast<std::size_t>(corner.dx), static_cast<std::size_t>(corner.dy));
      boxes_.push_back(box);
      tiles_.push_back({.base = static_cast<std::uint32_t>(base), .size = size, .first = next, .count = tile->count});
      tile->next = next;
      next += (tile->count + kStampGroup - 1) / kStampGroup * kStampGroup;
      most_ = std::max(most_, tile->count);
    }
  }
  words_.clear();
  for (StampTile& t : tiles_) {
    t.first += 4 * tile_count();
    words_.insert(words_.end(), {t.base, t.size, t.first, t.count});
  }
  for (Reached& reached : reached_) reached.next += 4 * tile_count();
  words_.resize(words_.size() + next);
}

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
