// The part of a growing map that a scan can reach from a window of poses, prepared for certified matching; kept as long
// as neither the part nor its cells change. Which part it is depends on the window alone, so that results do not depend
// on what was searched before. Not thread-safe. Cost: some 2 ns a cell when it is made for a window of up to a metre,
// 4 ns for a larger one, a comparison of its cells else.
#pragma once

#include <memory>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {

/// Part of a map that a search needs.
struct ReachedCells {
  CellBox box;  ///< holds every cell that a point may fall into, in map cells
  CertifiedMap::Windows windows = CertifiedMap::kSmallWindows;
};

class CertifiedCrop {
 public:
  /// Distances count up to `cap`, 1/256 cell, or up to the map's where that is less.
  explicit CertifiedCrop(std::uint32_t cap) : cap_(cap) {}
  const CertifiedMap& of(const GlobalField& map, const ReachedCells& reached, Isa isa);

 private:
  std::uint32_t cap_;
  CellBox box_{};
  CertifiedMap::Windows windows_ = CertifiedMap::kSmallWindows;
  std::vector<std::uint16_t> cells_;
  std::vector<std::uint16_t> fresh_;
  std::unique_ptr<CertifiedMap> prepared_;
};

/// The cells that points fall into from any pose of the window, and what is worth preparing for it.
ReachedCells reached_from(const PoseWindow& window, std::span<const PointCells> points, double resolution_m);

}  // namespace gdtslam
