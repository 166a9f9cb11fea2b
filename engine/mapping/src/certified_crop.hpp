// The part of a growing map that a scan can reach from a window of poses, prepared for certified matching; kept as long
// as neither the part nor its cells change. Which part it is depends on the window alone, so that results do not depend
// on what was searched before. Not thread-safe. Cost: some 40 ns a cell when it is made, a comparison of its cells
// else.
#pragma once

#include <memory>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {

class CertifiedCrop {
 public:
  /// `reached` holds every cell that a point may fall into, in map cells.
  const CertifiedMap& of(const GlobalField& map, const CellBox& reached, Isa isa);

 private:
  CellBox box_{};
  std::vector<std::uint16_t> cells_;
  std::vector<std::uint16_t> fresh_;
  std::unique_ptr<CertifiedMap> prepared_;
};

/// The cells that points fall into from any pose of the window, in map cells.
CellBox reached_from(const PoseWindow& window, std::span<const PointCells> points, double resolution_m);

}  // namespace gdtslam
