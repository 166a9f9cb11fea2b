// The beams of one scan from the sensor to what they hit, and the newest points brighter than the rest. Frame map. One
// object belongs to one thread; O(points) a call.
#pragma once

#include <vtkSmartPointer.h>

#include <span>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

class vtkActor;
class vtkRenderer;

namespace gdtslam {

struct Fading {
  double now_s = 0.0;
  double fades_s = 0.3;
  double size_px = 2.0;
};

class ScanningBeams {
 public:
  explicit ScanningBeams(vtkRenderer& renderer);
  /// A sheet through all the scan's points in the order of its beams, torn where beams are missing, and some of the
  /// beams as lines.
  void set_scan(const Point3& sensor_m, std::span<const CloudPoint> scan);
  /// Points of the last moments; the older the nearer to the colour of the beams.
  void set_fresh(const Point3& sensor_m, std::span<const CloudPoint> points, const Fading& fading);

 private:
  vtkSmartPointer<vtkActor> sheet_;
  vtkSmartPointer<vtkActor> lines_;
  vtkSmartPointer<vtkActor> fresh_;
};

}  // namespace gdtslam
