// Points sorted into cubes, to thin a cloud and to find connected groups of points. Metres. The result depends on
// neither a hash nor the number of threads. O(n log n).
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

/// The cubes that contain points, and the points of each.
class PatchCells {
 public:
  /// Cells of the points with these indices. The edge grows if the extent needs more than 2^20 cubes along an axis.
  PatchCells(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points, double edge_m);

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(keys_.size()); }
  [[nodiscard]] double edge_m() const { return edge_m_; }
  /// Indices into the cloud, ascending.
  [[nodiscard]] std::span<const std::uint32_t> cell_points(std::uint32_t cell) const {
    return {points_.data() + begins_[cell], points_.data() + begins_[cell + 1]};
  }
  /// The cell of each point, in the order of the given indices.
  [[nodiscard]] const std::vector<std::uint32_t>& cell_by_point() const { return cell_of_; }
  /// The mean of the points of each cell.
  [[nodiscard]] Cloud cell_means(std::span<const CloudPoint> cloud) const;
  /// Finds the cells that touch. Call it before largest_group and grown.
  void link();
  /// The largest connected group of marked cells, ascending. Size is the number of cells; of equal groups the first is
  /// returned.
  [[nodiscard]] std::vector<std::uint32_t> largest_group(const std::vector<bool>& is_marked) const;
  /// The marked cells and those that touch one of them.
  [[nodiscard]] std::vector<bool> grown(const std::vector<bool>& is_marked) const;

 private:
  [[nodiscard]] std::uint32_t find(std::uint64_t key) const;

  double edge_m_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> begins_;
  std::vector<std::uint32_t> points_;
  std::vector<std::uint32_t> cell_of_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links_;
};

/// All finite points except those farther from the bulk than ten times its extent, because the distance of a single
/// outlier would set the size of every cube.
std::vector<std::uint32_t> usable_points(std::span<const CloudPoint> cloud);

}  // namespace gdtslam
