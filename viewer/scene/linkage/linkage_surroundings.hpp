// What stands still around a moving linkage: the paths of its joints, the coupler's curve, the laser's sweep, the dead
// points; and the lights that scenes of a mount share. Frame `axis` of linkage_parts.hpp. One object belongs to one
// thread.
#pragma once

#include <vector>

#include "linkage_cycle.hpp"
#include "linkage_parts.hpp"

namespace gdtslam {

/// A key light from the upper left, a soft one from the right, the rest from the camera.
void add_lights(vtkRenderer& renderer);

class LinkageSurroundings {
 public:
  /// `marks` is the colour of the dead points.
  LinkageSurroundings(const LinkageCycle& cycle, const LinkageParts& parts, Colour marks);
  void add_to(vtkRenderer& renderer) const;
  /// Places that a picture of the whole motion has to show.
  [[nodiscard]] const std::vector<Point3>& reach() const { return reach_; }
  [[nodiscard]] double reach_m() const { return reach_m_; }
  /// Where the rocker's end turns back: begin and end of the lift, or of the stretch.
  [[nodiscard]] const std::vector<Point3>& dead_points() const { return dead_points_; }
  /// On the rim of the laser's sweep, for a label.
  [[nodiscard]] Point3 sweep_rim(double elevation_rad, double share) const;

 private:
  void add_paths(const LinkageCycle& cycle, const LinkageParts& parts);
  void add_sweep(const LinkageCycle& cycle);
  void add_dead_points(const LinkageCycle& cycle, const LinkageParts& parts, Colour marks);
  void find_reach(const LinkageCycle& cycle, const LinkageParts& parts);

  LinkagePlane plane_;
  double thin_m_;
  double sweep_m_;
  double sweep_y_;
  Part still_;
  std::vector<Point3> reach_;
  double reach_m_ = 1.0;
  std::vector<Point3> dead_points_;
};

}  // namespace gdtslam
