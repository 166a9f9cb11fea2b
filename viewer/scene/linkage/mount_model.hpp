// A small differential-drive robot with the nodding mount on its mast, as VTK props: body, wheels, caster, mast, the
// four bars with their joints, the laser. Built once; crank and pose only move the parts. Frame: base_link (x forward,
// y left, z up, on the floor); metres, radians. One object belongs to one thread; moving costs a few dozen small
// matrices.
#pragma once

#include <optional>

#include "linkage_parts.hpp"

namespace gdtslam {

class MountModel {
 public:
  /// Without a model: a robot with a laser at 0.3 m. Without the linkage the laser tilts by itself and only the model's
  /// mount is used; `T_base_level` is then the laser's pose at elevation 0, from the log. Throws ConfigError if the
  /// loop never closes.
  explicit MountModel(const calib::SweepModel* model, bool with_linkage = true, const Pose2& T_base_level = {});
  MountModel(const MountModel&) = delete;
  MountModel& operator=(const MountModel&) = delete;

  /// Adds the props to the renderer; they follow every later call.
  void add_to(vtkRenderer& renderer);
  void place(const Pose2& T_map_base);
  /// Does nothing if the loop does not close.
  void set_crank(double crank_rad);
  /// Moves the linkage to this elevation, rising or falling, or to the nearest one within reach. Without a linkage
  /// moves the laser alone.
  void set_elevation(double elevation_rad, bool is_rising = true);
  [[nodiscard]] bool has_linkage() const { return cycle_.has_value(); }
  void set_visible(bool is_visible);
  /// The sensor's centre and the direction of its forward beam, in the map.
  [[nodiscard]] Pose3 T_map_laser() const;

 private:
  [[nodiscard]] double axis_m() const { return mount_.height_m - mount_.lever_up_m; }
  [[nodiscard]] Pose3 T_base_axis() const;
  /// Two cheeks that carry the axle, the right one with the crank's pivot.
  void add_mast(double body_top_m);
  void move();

  Pose2 T_base_level_;
  NoddingMount mount_;
  std::optional<calib::LinkageCycle> cycle_;
  std::optional<LinkageParts> linkage_;
  Part robot_;
  Part mast_;
  Part lone_laser_;             ///< laser of a robot without a linkage
  double elevation_rad_ = 0.0;  ///< elevation of that laser
  Pose2 T_map_base_;
  double crank_rad_ = 0.0;
};

}  // namespace gdtslam
