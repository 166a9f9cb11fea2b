// The distance field of one scan, paper equation (1), on the window of its points, ready to be merged; made on the
// device from the cells of its points, in buffers that are kept from scan to scan. Not thread-safe.
#pragma once

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/global_field.hpp"

namespace gdtslam {

class LocalField {
 public:
  LocalField(Backend& backend, std::uint32_t radius_cells);

  /// Field of a keyframe's cells on its window.
  void compute(const KeyframeCells& keyframe);
  /// Merges it into the map, paper equations (9) to (11); the map must hold the window and live on the same backend.
  void merge_into(GlobalField& map, const MergeStep& step);

 private:
  void reserve(std::size_t cells);

  Backend* backend_;
  std::uint32_t radius_;
  CellBox window_{};
  std::uint32_t stride_ = 0;
  Buffer table_;
  std::uint32_t table_size_ = 0;
  Buffer cells_;
  Buffer seeds_;
  Buffer column_distance_;
  Buffer squared_distance_;
  Buffer field_;
};

}  // namespace gdtslam
