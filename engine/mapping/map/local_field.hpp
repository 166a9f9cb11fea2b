// A keyframe's distance field, paper equation (1), merged into the map by (9) to (11). The exact one is stamped into
// the tiles that its obstacles reach; jump flooding makes the field of the whole window first. In buffers that are kept
// from keyframe to keyframe. Not thread-safe.
#pragma once

#include <cstdint>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "stamps.hpp"

namespace gdtslam {

class LocalField {
 public:
  LocalField(Backend& backend, std::uint32_t radius_cells, DistanceTransform transform = DistanceTransform::kExact);

  /// Prepares a keyframe for a map that holds its window and lives on the same backend. Throws InputError where the map
  /// may not take so much memory, what the backend throws else; the map is as before then.
  void prepare(const KeyframeCells& keyframe, const GlobalField& map);
  /// Merges it into that map, which has not grown since.
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
