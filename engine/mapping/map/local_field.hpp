// A keyframe's distance field, paper equation (1), merged into the map by (9) to (11). The exact field is stamped into
// the tiles that its obstacles reach; jump flooding makes the field of the whole window first. Buffers are kept from
// keyframe to keyframe. Not thread-safe.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/gdt_stamp/gdt_stamp.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/global_field.hpp"

namespace gdtslam {

// The tiles of the map that a keyframe's obstacles reach, and the obstacles of each (GdtStamp).

/// The lists of one keyframe; reused for the next, so that they allocate nothing. Cost: linear in the obstacles and in
/// the tiles of the keyframe's window.
class StampLists {
 public:
  explicit StampLists(std::uint32_t radius_cells) : radius_(static_cast<std::int32_t>(radius_cells)) {}

  /// Sorts the keyframe's obstacles by the tiles of the map, which must hold its window.
  void list(const KeyframeCells& keyframe, const GlobalField& map);

  [[nodiscard]] std::uint32_t tile_count() const { return static_cast<std::uint32_t>(tiles_.size()); }
  /// The list in the format of the kernel.
  [[nodiscard]] const std::vector<std::uint32_t>& words() const { return words_; }
  /// The tiles, map cells.
  [[nodiscard]] const std::vector<CellBox>& boxes() const { return boxes_; }
  [[nodiscard]] std::uint32_t most_obstacles() const { return most_; }

 private:
  // A tile that discs may reach: the number of discs, and the position of the next one in the list.
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

class LocalField {
 public:
  LocalField(Backend& backend, std::uint32_t radius_cells, DistanceTransform transform = DistanceTransform::kExact);

  /// Prepares a keyframe for a map that holds its window and lives on the same backend. Throws InputError if the map
  /// would take too much memory, and the backend's exceptions; the map is unchanged then.
  void prepare(const KeyframeCells& keyframe, const GlobalField& map);
  /// Merges it into that map, which must not have grown since.
  void merge_into(GlobalField& map, const MergeStep& step);

 private:
  void reserve(std::size_t cells);
  void flood(const KeyframeCells& keyframe);
  void stamp_into(GlobalField& map, const MergeStep& step);

  Backend* backend_;
  std::uint32_t radius_;
  DistanceTransform transform_;
  Buffer values_;  // distances: the disc that is stamped, or by squared distance
  Buffer cells_;   // obstacle cells
  StampLists lists_;
  // State of jump flooding.
  CellBox window_{};
  std::uint32_t stride_ = 0;
  Buffer seeds_;
  Buffer nearest_[2];  // a step reads one and writes the other
  Buffer squared_distance_;
  Buffer field_;
};

}  // namespace gdtslam
