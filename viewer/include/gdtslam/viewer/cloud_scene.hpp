// A 3D cloud with the robot and its path, drawn with VTK: colours by height, elevation, time, scan or distance to
// another cloud, eye-dome lighting, optional floor and ceiling. Frame: map, z up, metres. Memory per point: 16 bytes, 8
// for its time, 4 while a large picture is drawn, 8 while a cloud is set. The CPU draws the points, OpenGL everything
// else: about 0.1 s of CPU time per million points and frame of 1280 x 720. One object belongs to one thread.
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
#include "gdtslam/viewer/camera.hpp"
#include "gdtslam/viewer/graphics.hpp"

namespace gdtslam {

enum class CloudColour : std::uint8_t { kHeight, kElevation, kTime, kScan, kDistance, kPlain };

/// Appearance of a cloud.
struct CloudLook {
  CloudColour colour = CloudColour::kHeight;
  std::string colour_map;       ///< empty: the map for this colour and background
  std::optional<double> least;  ///< lower end of the scale (m, rad, s from the first point on, scans, m); empty: the
                                ///< 1st percentile of the drawn points, for distances 0
  std::optional<double> most;   ///< upper end; empty: the 99th percentile
  bool with_floor = true;
  bool with_ceiling = true;  ///< tools set it false for views from above: a ceiling hides the rooms
  bool with_eye_dome = true;
  bool is_dark = true;          ///< background
  bool is_transparent = false;  ///< background
  std::uint32_t samples = 2;    ///< per pixel side, for smooth edges; 1 in films of clouds
};

/// Meaning of the colours in a picture.
struct ColourScale {
  std::string quantity;  ///< "Height"
  std::string unit;      ///< "m", "s", degrees as "°"; empty: a number; without a quantity: nothing to explain
  double least = 0.0;
  double most = 1.0;
  std::string colour_map;
};

/// A cloud with map, path and robot.
class CloudScene {
 public:
  CloudScene(const GraphicsContext& graphics, const CloudLook& look);
  ~CloudScene();
  CloudScene(const CloudScene&) = delete;
  CloudScene& operator=(const CloudScene&) = delete;

  /// Call it once. Detects floor and ceiling (cloud/thinning.hpp); if they are hidden, so is everything within 6 cm of
  /// the floor and 25 cm of the ceiling, lamps included. Points that are not finite are not drawn. Throws InputError
  /// for a cloud without points, ConfigError for an invalid scale or colour map. `distances_m` is for kDistance: one
  /// per point, for example to a reference cloud or to true surfaces.
  void set_cloud(std::span<const CloudPoint> cloud, std::span<const float> distances_m = {});
  void set_trajectory(const Trajectory& trajectory);
  /// Shows the robot, with the mount at this elevation if a model is given; points never hide it. The model must live
  /// while it is shown.
  void set_robot(const std::optional<Pose2>& T_map_base, const calib::SweepModel* model = nullptr,
                 double elevation_rad = 0.0);
  /// Draws only points (and path) up to this stamp; infinity: all. Points need not be sorted by time.
  void show_until(double stamp_s);

  /// Bounds of the drawn points without outliers: 0.1 % at each end of an axis, and isolated points if they are less
  /// than 1 % of all.
  [[nodiscard]] const Bounds& bounds() const;
  [[nodiscard]] const ColourScale& scale() const;
  [[nodiscard]] std::uint64_t points_drawn() const;

  /// The scene without words.
  RgbaImage render(const Camera& camera, const PictureSize& size);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Words and bars over the scene.
struct CloudCaption {
  std::string title;      ///< name of the cloud
  std::string subtitle;   ///< "2,612,034 points, 63 m of path"
  bool with_bars = true;  ///< scale bar, axes and colour bar
};
/// The scene's picture with title, scale bar (of a perspective camera: at its target, with a note), colour bar and
/// axes, in order of importance: a part without room is left out.
Canvas cloud_picture(std::shared_ptr<const RgbaImage> scene, const ColourScale& scale, const Camera& camera,
                     const CloudLook& look, const CloudCaption& caption);
/// Distance of each point to its nearest neighbour in the reference, metres, at most `most_m`. O(n log m).
std::vector<float> distances_to(std::span<const CloudPoint> cloud, std::span<const CloudPoint> reference,
                                double most_m = 1.0);
/// Keeps at most `most` of the finite points: all while there is room, then the first in each voxel, with voxels as
/// large as that limit requires. Memory: some 40 bytes per kept point. Throws InputError for a cloud that is too wide.
class PointLimit : public CloudSink {
 public:
  explicit PointLimit(std::size_t most);
  ~PointLimit() override;
  /// Sets the expected number of points, if known, to choose the voxels.
  void expect(std::uint64_t points);
  void add(std::span<const CloudPoint> points) override;
  /// Returns the kept points in their order and empties the limit.
  Cloud take();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
