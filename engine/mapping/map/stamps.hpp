// Which tiles of the map a keyframe's obstacles reach, and the obstacles of each (GdtStamp).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/compute/kernels/gdt_stamp/gdt_stamp.hpp"
#include "gdtslam/mapping/global_field.hpp"

namespace gdtslam {

/// The lists of one keyframe; kept from one to the next, so that they allocate nothing. Cost: linear in the obstacles
/// and in the tiles of the keyframe's window.
class StampLists {
 public:
  explicit StampLists(std::uint32_t radius_cells) : radius_(static_cast<std::int32_t>(radius_cells)) {}

  /// Sorts the keyframe's obstacles by the tiles of the map, which must hold its window.
  void list(const KeyframeCells& keyframe, const GlobalField& map);

  [[nodiscard]] std::uint32_t tile_count() const { return static_cast<std::uint32_t>(tiles_.size()); }
  /// The list that the kernel takes.
  [[nodiscard]] const std::vector<std::uint32_t>& words() const { return words_; }
  /// The tiles, map cells.
  [[nodiscard]] const std::vector<CellBox>& boxes() const { return boxes_; }
  [[nodiscard]] std::uint32_t most_obstacles() const { return most_; }

 private:
  // A tile that a disc may reach: how many do, and the place of the next one in the list.
  struct Reached {
    std::uint32_t count = 0;
    std::uint32_t next = 0;
  };
  template <class See>
  void for_each_reached(const KeyframeCells& keyframe, See see);
  void lay_out(const GlobalField& map);

  std::int32_t radius_;
  CellOffset window_;             // the window's lower left cell within the map's grid
  CellBox reach_;                 // tiles of the map's grid that the window touches
  std::vector<Reached> reached_;  // by tile of reach_, row by row
  std::vector<StampTile> tiles_;
  std::vector<CellBox> boxes_;
  std::vector<std::uint32_t> words_;
  std::uint32_t most_ = 0;
};

}  // namespace gdtslam
