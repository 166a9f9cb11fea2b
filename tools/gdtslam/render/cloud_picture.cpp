#include "cloud_picture.hpp"

#include <memory>

#include "engine/runs/folder/run_pictures.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"
#include "source.hpp"
#include "studio.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"

namespace gdtslam {

std::string draw_run_cloud(const std::string& cloud_file, const std::string& log, const Trajectory& trajectory,
                           const calib::SweepModel* linkage) {
  constexpr PictureSize kSize{1600, 900};
  const GraphicsContext graphics;
  CloudLook look;
  look.with_ceiling = false;
  CloudScene scene(graphics, look);
  std::uint64_t points = 0;
  {
    const PointsOfCloud still = read_cloud(cloud_file, {.most = points_of_still(kSize)});
    points = still.points;
    scene.set_cloud(still.cloud);
  }
  scene.set_trajectory(trajectory);
  scene.set_robot(trajectory.back().T_map_base, linkage);
  const Camera camera = fitting_camera(CameraPreset::kIso, scene.bounds(), kSize);
  const CloudCaption caption{.title = run_title({log}),
                             .subtitle = cloud_subtitle(scene.points_drawn(), points, path_length_text(trajectory))};
  const auto image = std::make_shared<const RgbaImage>(scene.render(camera, kSize));
  return png_bytes(raster_of(cloud_picture(image, scene.scale(), camera, look, caption)));
}

}  // namespace gdtslam
