// Poses in space for a nodding laser: keeps the planar path and the points of a run until all are known, finds the
// corrections (strokes/stroke_adjustment.hpp), and gives the corrected points on. One object belongs to one thread.
// Memory: surfels, and a few megabytes of points; the rest of them lie in a file without a name.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "engine/core/memory/byte_shelf.hpp"
#include "engine/mapping/strokes/path_correction.hpp"
#include "engine/mapping/strokes/surfels.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

class SpacePath {
 public:
  SpacePath(const NoddingMount& mount, std::string scratch_folder);
  /// Takes the planar pose of the next scan.
  void take(const NoddingPose& pose, const NoddingScan& scan);
  /// Takes the points of scans, in log order.
  void add(std::span<const CloudPoint> points);
  /// Call it when all poses and points are there, at least one pose.
  SpaceOutcome solve(unsigned threads, const std::function<void(double)>& progress);
  /// Gives all corrected points, in their order. Throws FileError.
  void give(const std::function<void(std::span<const CloudPoint>)>& sink) const;

 private:
  NoddingMount mount_;
  PlanarPath path_;
  SurfelCollector surfels_{SurfelOptions{}};
  ByteShelf points_;
  double lowest_rad_ = std::numeric_limits<double>::infinity();
  double highest_rad_ = -std::numeric_limits<double>::infinity();
  std::optional<PathCorrection> correction_;
};

}  // namespace gdtslam
