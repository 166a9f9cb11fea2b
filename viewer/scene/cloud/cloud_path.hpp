// The robot's path over a cloud: a tube on the floor with marks at start and end. One object belongs to one thread;
// O(poses) when its end or its width changes.
#pragma once

#include <vtkNew.h>

#include <functional>
#include <limits>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/viewer/camera.hpp"

class vtkActor;
class vtkRenderer;

namespace gdtslam {

class CloudPath {
 public:
  /// Height of the floor, which the path is drawn on.
  using FloorHeight = std::function<double(const Point2&)>;
  CloudPath(vtkRenderer& renderer, bool is_dark);
  ~CloudPath();
  CloudPath(const CloudPath&) = delete;
  CloudPath& operator=(const CloudPath&) = delete;

  void set(const Trajectory& trajectory, const FloorHeight& floor_m);
  void show_until(double stamp_s) { until_s_ = stamp_s; }
  /// Rebuilds the tube if its width or end has changed; call it before each picture.
  void prepare(double width_m);
  /// The box of the whole path.
  [[nodiscard]] const Bounds& bounds() const { return bounds_; }

 private:
  struct Place {
    double stamp_s = 0.0;
    Point3 at;
  };
  void build(double width_m, std::size_t count);

  std::vector<Place> places_;
  Bounds bounds_;
  double until_s_ = std::numeric_limits<double>::infinity();
  double built_width_m_ = 0.0;
  std::size_t built_count_ = 0;
  vtkNew<vtkActor> tube_;
  vtkNew<vtkActor> start_;
  vtkNew<vtkActor> end_;
};

}  // namespace gdtslam
