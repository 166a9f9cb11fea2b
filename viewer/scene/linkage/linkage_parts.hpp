// Shapes of the mount and the robot, from VTK's sources, and the nodding linkage as VTK props: four bars with their
// joints, ground, laser in its cradle, fan of beams. Built once for a model, then only moved. Shapes are triangles with
// normals; outlines are in the plane of x and z and extruded along y, with the viewer at negative y. Frame `axis`:
// origin on the nodding axis (the rocker's pivot) in the laser's middle, x forward, y left, z up. The linkage is in x-z
// planes on the right; the rocker is drawn at the laser's elevation. Also the lights of all mount scenes. Metres,
// radians. One object belongs to one thread; O(vertices).
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "calib/linkage/linkage_cycle.hpp"
#include "gdtslam/core/pose3.hpp"
#include "gdtslam/drawing/colour.hpp"

class vtkActor;
class vtkRenderer;

namespace gdtslam {

using Mesh = vtkSmartPointer<vtkPolyData>;

/// Extrudes a convex polygon grown by `radius`; corners counter-clockwise as seen from negative y. One corner gives a
/// disc, two a bar with round ends.
Mesh extruded(std::vector<Point2> corners, double radius, double front_y, double back_y);
/// The same for a polygon in x and y, from one height to another.
Mesh upright(const std::vector<Point2>& corners, double radius, double low_z, double high_z);
/// A rectangle with rounded corners, by its lowest and highest corner.
struct RoundedBox {
  Point2 lowest;
  Point2 highest;
  double radius = 0.0;
  [[nodiscard]] std::vector<Point2> corners() const;
};
/// Tubes along paths; consecutive equal points of a path are merged.
Mesh tubes(const std::vector<std::vector<Point3>>& paths, double radius);
/// A flat band between two curves with equal numbers of points.
Mesh band(const std::vector<Point3>& inner, const std::vector<Point3>& outer);
Mesh ball(const Point3& centre, double radius);

/// Response of a prop's surface to light.
enum class Finish : std::uint8_t { kPaint, kSteel, kGlass, kFlat };
vtkSmartPointer<vtkActor> make_actor(const Mesh& mesh, Colour colour, Finish finish = Finish::kPaint,
                                     double opacity = 1.0);
/// Props that move together.
struct Part {
  std::vector<vtkSmartPointer<vtkActor>> actors;
  void add(const Mesh& mesh, Colour colour, Finish finish = Finish::kPaint, double opacity = 1.0);
  void move(const Pose3& T_world_part);
  void show(bool is_visible);
  void add_to(vtkRenderer& renderer) const;
};

/// Sizes that do not follow from the bars' lengths.
struct PartSizes {
  double bar_m = 0.006;  ///< half the width of a bar
  double laser_m = 0.06;
  double fan_m = 0.3;     ///< 0: none
  bool with_feet = true;  ///< the ground's hatched feet, as in textbooks; else a motor
};
/// Default sizes for these bars.
PartSizes suitable_sizes(const calib::FourBar& bars);

/// The sensor in the frame of the axis, for any mount.
Pose3 T_axis_laser(const NoddingMount& mount, double elevation_rad);

/// The sensor alone, centred at the origin, about a cube of this side.
Part laser_part(double side);

class LinkageParts {
 public:
  static constexpr std::size_t kCount = 7;
  static constexpr std::array<std::string_view, kCount> kNames{"ground", "crank", "coupler", "rocker",
                                                               "cradle", "laser", "fan"};
  /// Poses of the parts, in the order of their names.
  using Poses = std::array<Pose3, kCount>;

  LinkageParts(const calib::SweepModel& model, const PartSizes& sizes);
  LinkageParts(const LinkageParts&) = delete;
  LinkageParts& operator=(const LinkageParts&) = delete;
  ~LinkageParts() = default;

  void add_to(vtkRenderer& renderer) const;
  /// False, without motion, if the loop does not close.
  bool pose(const Pose3& T_world_axis, double crank_rad);
  /// Empty if the loop does not close.
  [[nodiscard]] std::optional<Poses> poses_at(const Pose3& T_world_axis, double crank_rad) const;
  [[nodiscard]] const Part& part(std::size_t number) const { return parts_.at(number); }
  void show(bool is_visible);
  /// Middle of a layer: 0 ground, 1 rocker, 2 crank, 3 coupler.
  [[nodiscard]] double layer_y(int layer) const;
  [[nodiscard]] const PartSizes& sizes() const { return sizes_; }

 private:
  void build_bars();
  void build_ground();
  void build_laser();
  void build_fan();
  /// Arc of the beams at a radius, cut off at the linkage.
  [[nodiscard]] std::vector<Point3> fan_arc(double radius_m) const;
  [[nodiscard]] double beam_length_m(const Point2& unit, double most_m) const;
  /// A pin between two layers with its cap in front.
  void add_pin(Part& part, const Point2& at, double back_y, int front_layer) const;
  [[nodiscard]] double thickness_m() const;

  calib::SweepModel model_;
  PartSizes sizes_;
  std::array<Part, kCount> parts_;
  Part& ground_ = parts_[0];
  Part& crank_ = parts_[1];
  Part& coupler_ = parts_[2];
  Part& rocker_ = parts_[3];
  Part& cradle_ = parts_[4];
  Part& laser_ = parts_[5];
  Part& fan_ = parts_[6];
};

/// A key light from the upper left, a soft one from the right, the rest from the camera.
void add_lights(vtkRenderer& renderer);

}  // namespace gdtslam
