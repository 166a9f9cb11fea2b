// What a frame costs where OpenGL runs on the processor: a cloud of a million points, one thinned for a film, and the
// linkage with its panel, each until the pixels are there.
#include <cstdint>
#include <memory>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"
#include "gdtslam/viewer/graphics.hpp"
#include "gdtslam/viewer/linkage_scene.hpp"
#include "tools/lab/bench/rows.hpp"

namespace gdtslam {
namespace {

constexpr PictureSize kSize{1280, 720};

void measure_cloud(benchmark::State& state, const GraphicsContext& graphics, std::size_t points,
                   std::uint32_t samples) {
  CloudLook look;
  look.samples = samples;
  CloudScene scene(graphics, look);
  scene.set_cloud(bench_hall(points));
  Camera camera = fitting_camera(CameraPreset::kIso, scene.bounds(), kSize);
  const auto frame = [&] {
    camera = turned(camera, 0.01);
    (void)scene.render(camera, kSize);
  };
  time_work(state, {.step = frame}, 1.0, "frame");
}

}  // namespace

void add_frames(const BenchTarget& cpu) {
  const auto graphics = shared_by_rows([] { return std::make_shared<GraphicsContext>(); });
  const auto add_cloud = [&](const char* variant, std::size_t points, std::uint32_t samples) {
    add_row(cpu, "viewer", "cloud_frame", variant, [graphics, points, samples](benchmark::State& state) {
      measure_cloud(state, graphics(), points, samples);
    });
  };
  add_cloud("1,000,000 points, 1280x720", 1'000'000, 1);
  add_cloud("1,000,000 points, 1280x720, 2x2 samples", 1'000'000, 2);
  add_cloud("150,000 points, 1280x720", 150'000, 1);
  add_row(cpu, "viewer", "linkage_frame", "scene and panel, 1280x720", [graphics](benchmark::State& state) {
    const calib::SweepModel model = calib::sweep_model_of_preset(calib::kDefaultLinkage);
    LinkageScene linkage(graphics(), model, {});
    double crank_rad = 0.0;
    const auto frame = [&] { (void)rasterise(linkage.picture(crank_rad += 0.01, kSize)); };
    time_work(state, {.step = frame}, 1.0, "frame");
  });
}

}  // namespace gdtslam
