// What a frame costs where OpenGL runs on the processor: a cloud of a million points, one thinned for a film, and the
// linkage with its panel, each until the pixels are there.
#include <optional>
#include <string>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/raster.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"
#include "gdtslam/viewer/graphics.hpp"
#include "gdtslam/viewer/linkage_scene.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/lab/bench/rows.hpp"

namespace gdtslam {
namespace {

constexpr PictureSize kSize{1280, 720};

BenchRow cloud_frames(const GraphicsContext& graphics, std::size_t points, std::uint32_t samples,
                      const std::string& variant, const TimingOptions& options) {
  CloudLook look;
  look.samples = samples;
  CloudScene scene(graphics, look);
  scene.set_cloud(bench_hall(points));
  Camera camera = fitting_camera(CameraPreset::kIso, scene.bounds(), kSize);
  const auto frame = [&scene, camera]() mutable {
    camera = turned(camera, 0.01);
    (void)scene.render(camera, kSize);
  };
  return measured_row("viewer", "cloud_frame", variant, "frame", 1.0, {.step = frame}, options);
}

}  // namespace

std::vector<BenchRow> bench_viewer(const TimingOptions& options) {
  std::optional<GraphicsContext> graphics;
  try {
    graphics.emplace();
  } catch (const UnavailableError& error) {
    print_remark(std::string("bench: no frames are measured: ") + error.what());
    return {};
  }
  std::vector<BenchRow> rows;
  rows.push_back(cloud_frames(*graphics, 1'000'000, 1, "1,000,000 points, 1280x720", options));
  rows.push_back(cloud_frames(*graphics, 1'000'000, 2, "1,000,000 points, 1280x720, 2x2 samples", options));
  rows.push_back(cloud_frames(*graphics, 150'000, 1, "150,000 points, 1280x720", options));
  const calib::SweepModel model = calib::sweep_model_of_preset(calib::kDefaultLinkage);
  LinkageScene linkage(*graphics, model, {});
  double crank_rad = 0.0;
  const auto frame = [&] { (void)raster_of(linkage.picture(crank_rad += 0.01, kSize)); };
  rows.push_back(
      measured_row("viewer", "linkage_frame", "scene and panel, 1280x720", "frame", 1.0, {.step = frame}, options));
  return rows;
}

}  // namespace gdtslam
