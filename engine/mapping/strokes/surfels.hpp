// Flat pieces of surfaces (surfels), one set for each stroke of the mount: strokes are compared by them. Frame: map,
// metres. One collector belongs to one thread. Memory: the points of one stroke, and 80 bytes a surfel. Cost: O(points
// log points) of a stroke.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"
#include "stroke_sample.hpp"

namespace gdtslam {

/// The points of one stroke in a cube of space, if they lie in a plane.
struct Surfel {
  Point3 mean = Point3::Zero();
  Point3 normal = Point3::Zero();  ///< of unit length, of either sign
  double scan = 0.0;               ///< mean number of the points' scans
  double elevation_rad = 0.0;      ///< mean elevation of the scan plane
  std::uint32_t stroke = 0;
};

struct SurfelOptions {
  double cell_m = 0.5;
  std::size_t fewest = 6;            ///< points of a surfel
  double flat = 0.04;                ///< variance along the normal, as a share of the lesser one in the plane
  double thick_m = 0.05;             ///< largest standard deviation along the normal, least in the plane
  std::size_t most_points = 40'000;  ///< of a stroke; of more, every second, fourth... is taken
};

class SurfelCollector {
 public:
  explicit SurfelCollector(const SurfelOptions& options) : options_(options), sample_(options.most_points) {}
  /// Takes points in log order; their scans must have numbers that ascend.
  void add(std::span<const CloudPoint> points);
  /// The surfels of all strokes, in their order.
  std::vector<Surfel> finish();
  /// All strokes, after finish().
  [[nodiscard]] const std::vector<Stroke>& strokes() const { return strokes_; }

 private:
  void close_stroke();

  SurfelOptions options_;
  StrokeSample sample_;
  std::vector<Stroke> strokes_;
  std::vector<Surfel> surfels_;
};

}  // namespace gdtslam
