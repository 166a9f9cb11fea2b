// The distance field of one scan, paper equation (1), on the window of its points, ready to be merged; made on the
// device from the cells of its points, in buffers that are kept from scan to scan. Not thread-safe.
#pragma once

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/global_field.hpp"

namespace gdtslam {

class LocalField {
 public:
  LocalField(Backend& backend, std::uint32_t radius_cells, DistanceTransform transform = DistanceTransform::kExact);

  /// Field of a keyframe's cells on its window.
  void compute(const KeyframeCells& keyframe);
  /// Merges it into the map, paper equations (9) to (11); the map must hold the window and live on the same backend.
  void merge_into(GlobalField& map, const MergeStep& step);

 private:
  void reserve(std::size_t cells);
  // From the seeds to the squared distances of the window.
  void transform_exactly();
  void flood();

  Backend* backend_;
  std::uint32_t radius_;
  DistanceTransform transform_;
  CellBox window_{};
  std::uint32_t stride_ = 0;
  Buffer table_;
  std::uint32_t table_size_ = 0;
  Buffer cells_;
  Buffer seeds_;
  Buffer column_distance_;  // of the exact transform
  Buffer nearest_[2];       // of jump flooding, which reads one and writes the other
  Buffer squared_distance_;
  Buffer field_;
};

}  // namespace gdtslam
