// A 3D cloud with the robot and its path, drawn with VTK: colours by height, elevation, time, scan or distance to
// another cloud, eye-dome lighting, floor and ceiling that can be taken away. Frame: map, z up, metres. Cost: 16 bytes
// of memory a point (twice while they go to OpenGL); about 0.35 s a million points and frame where OpenGL runs on the
// processor. One object belongs to one thread.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/viewer/camera.hpp"
#include "gdtslam/viewer/graphics.hpp"

namespace gdtslam {

enum class CloudColour : std::uint8_t { kHeight, kElevation, kTime, kScan, kDistance, kPlain };

struct CloudLook {
  CloudColour colour = CloudColour::kHeight;
  std::string colour_map;       ///< empty: the one that suits the colour
  std::optional<double> least;  ///< of the scale (m, rad, s, scans, m); nothing: the 1st percentile
  std::optional<double> most;   ///< likewise the 99th
  bool with_floor = true;
  bool with_ceiling = true;  ///< false by default in tools for views from above: a ceiling hides the rooms
  bool with_eye_dome = true;
  double point_px = 0.0;        ///< 0: by the density of the points on the picture
  bool is_dark = true;          ///< background
  bool is_transparent = false;  ///< background
  std::uint32_t samples = 2;    ///< per pixel side, for smooth edges; 1 in films of clouds
};

/// What a picture of the cloud needs to be read: what the colours mean.
struct ColourScale {
  std::string quantity;  ///< "Height"
  std::string unit;      ///< "m"; empty: a number
  double least = 0.0;
  double most = 1.0;
  std::string colour_map;
};

class CloudScene {
 public:
  CloudScene(const GraphicsContext& graphics, const CloudLook& look);
  ~CloudScene();
  CloudScene(const CloudScene&) = delete;
  CloudScene& operator=(const CloudScene&) = delete;

  /// Call once; floor and ceiling are found here (cloud/thinning.hpp). Throws InputError for a cloud without points.
  /// `distances_m` belongs to kDistance: one for each point, for example to a reference cloud or to true surfaces.
  void set_cloud(std::span<const CloudPoint> cloud, std::span<const float> distances_m = {});
  void set_trajectory(const Trajectory& trajectory);
  /// The 2D map as a picture in the plane z = 0.
  void set_map(const OccupancyMap& map);
  /// The robot, with the mount at this elevation where a model is given; nothing hides it.
  void set_robot(const std::optional<Pose2>& T_map_base, const calib::SweepModel* model = nullptr,
                 double elevation_rad = 0.0);
  /// Only points (and path) up to this stamp are drawn; infinity: all. Points need not be in the order of time.
  void show_until(double stamp_s);

  [[nodiscard]] const Bounds& bounds() const;  ///< of what is drawn, without stray points (0.1 % at each end)
  [[nodiscard]] const ColourScale& scale() const;
  [[nodiscard]] std::uint64_t points_drawn() const;

  /// The scene alone, without words.
  RgbaImage render(const Camera& camera, const PictureSize& size);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What stands beside the scene.
struct CloudCaption {
  std::string title;     ///< name of the cloud
  std::string subtitle;  ///< "2,612,034 points, 63 m of path"
  bool with_scale_bar = true;
  bool with_axes = true;
  bool with_colour_bar = true;
};
/// The scene's picture with title, colour bar, scale bar (at the camera's target) and axes drawn over it.
Canvas cloud_picture(std::shared_ptr<const RgbaImage> scene, const ColourScale& scale, const Camera& camera,
                     const CloudLook& look, const CloudCaption& caption);
/// Nearest-neighbour distance of each point to the reference, metres, beyond `most_m` that value. O(n log m).
std::vector<float> distances_to(std::span<const CloudPoint> cloud, std::span<const CloudPoint> reference,
                                double most_m = 1.0);
/// At most `most` points, spread evenly over the voxels of the cloud; the order is kept. For films.
Cloud thinned_for_film(std::span<const CloudPoint> cloud, std::size_t most);

}  // namespace gdtslam
