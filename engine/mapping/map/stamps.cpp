#include "stamps.hpp"

#include <algorithm>
#include <cassert>

#include "store/growth.hpp"

namespace gdtslam {
namespace {

constexpr auto kTile = static_cast<std::int32_t>(kStampTile);

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

// The tiles that are reached, and the places of their obstacles.
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

}  // namespace gdtslam
