// The distance field of one scan, paper equation (1), on the window of its points, ready to be merged; buffers are kept
// from scan to scan. Not thread-safe.
#pragma once

#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/compute/kernels/gdt_merge.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/global_field.hpp"

namespace gdtslam {

class LocalField {
 public:
  LocalField(Backend& backend, std::uint32_t radius_cells);

  /// Field of points of the map's frame on `window` (map cells; must hold every point).
  void compute(const std::vector<Point2>& points_map_m, double resolution_m, const CellBox& window);
  /// Merges it into the map, paper equations (9) to (11); the map must hold the window.
  void merge_into(GlobalField& map, MergeRule rule, std::uint32_t threshold, std::uint32_t lift);

 private:
  void reserve(std::uint32_t width, std::uint32_t height);

  Backend* backend_;
  std::uint32_t radius_;
  CellBox window_{};
  std::uint32_t stride_ = 0;
  std::size_t capacity_ = 0;
  std::vector<std::uint8_t> seeds_;
  Buffer table_;
  std::uint32_t table_size_ = 0;
  Buffer seed_buffer_;
  Buffer column_distance_;
  Buffer squared_distance_;
  Buffer field_;
};

}  // namespace gdtslam
