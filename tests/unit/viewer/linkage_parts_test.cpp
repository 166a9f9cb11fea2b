// The drawn linkage against the law of cosines, seen from the side by a parallel camera of our own.
#include <gtest/gtest.h>
#include <vtkRenderer.h>

#include <cmath>
#include <numeric>

#include "gdtslam/calib/crank_rocker.hpp"
#include "linkage_drawn.hpp"
#include "support/linkage_joints.hpp"
#include "viewer/graphics/offscreen_view.hpp"
#include "viewer/scene/linkage/linkage_parts.hpp"

namespace gdtslam {
namespace {

using namespace test;

constexpr PictureSize kPartsSize{640, 640};

/// From the right side: x is drawn to the right, z upward.
Camera side_camera(double height_m) {
  Camera camera;
  camera.eye = {0.0, -10.0 * height_m, 0.0};
  camera.target = Point3::Zero();
  camera.is_parallel = true;
  camera.parallel_height_m = height_m;
  return camera;
}

Point2 pixel(const Point2& place, double height_m) {
  const double scale = kPartsSize.height / height_m;
  return {0.5 * kPartsSize.width + scale * place.x(), 0.5 * kPartsSize.height - scale * place.y()};
}

calib::SweepModel falling_model() {
  calib::SweepModel model = calib::sweep_model_of_preset("paper-c");
  model.elevation_sign = -model.elevation_sign;
  model.elevation_offset_rad = 0.4;
  return model;
}

calib::SweepModel crossed_model() {
  calib::SweepModel model = calib::sweep_model_of({.crank_m = 0.4, .coupler_m = 1.0, .rocker_m = 0.9, .ground_m = 1.1},
                                                  calib::Assembly::kCrossed);
  model.mount.lever_forward_m = 0.2;
  return model;
}

struct Drawn {
  explicit Drawn(const calib::SweepModel& with)
      : model(with), parts(model, suitable_sizes(model.bars)), view(graphics) {
    view.set_background(ink::kNight, false);
    view.set_samples(2);
    add_lights(view.renderer());
    const calib::FourBar& bars = model.bars;
    height_m = 2.4 * (bars.ground_m + bars.crank_m + bars.rocker_m);
    cap_px = 0.5 * parts.sizes().bar_m * kPartsSize.height / height_m;
  }
  RgbaImage at(double crank_rad) {
    EXPECT_TRUE(parts.pose(Pose3{}, crank_rad));
    return view.render(side_camera(height_m), kPartsSize);
  }
  GraphicsContext graphics;
  calib::SweepModel model;
  LinkageParts parts;
  OffscreenView view;
  double height_m = 1.0;
  double cap_px = 1.0;
};

void expect_joints(const calib::SweepModel& model) {
  Drawn drawn(model);
  drawn.parts.add_to(drawn.view.renderer());
  drawn.parts.show_fan(false);
  const double scale = kPartsSize.height / drawn.height_m;
  int seen = 0;
  for (int i = 0; i < 8; ++i) {
    const double crank_rad = 0.3 + 0.785 * i;
    const auto joints = expected_joints(model, crank_rad);
    if (!joints) continue;
    const RgbaImage image = drawn.at(crank_rad);
    const auto cap = [&](std::size_t joint) {
      return cap_near(image, pixel((*joints)[joint], drawn.height_m), drawn.cap_px);
    };
    // A and B are in front of all else.
    const std::optional<Point2> crank_end = cap(1);
    const std::optional<Point2> coupler_end = cap(2);
    ASSERT_TRUE(crank_end && coupler_end) << model.name << ", crank " << crank_rad;
    EXPECT_LT((*crank_end - pixel((*joints)[1], drawn.height_m)).norm(), 1.0) << model.name << ", crank " << crank_rad;
    EXPECT_LT((*coupler_end - pixel((*joints)[2], drawn.height_m)).norm(), 1.0) << model.name << ' ' << crank_rad;
    EXPECT_NEAR((*coupler_end - *crank_end).norm(), scale * model.bars.coupler_m, 1.0) << "coupler, " << crank_rad;
    for (const std::size_t pivot : {std::size_t{0}, std::size_t{3}}) {
      const std::optional<Point2> found = cap(pivot);  // the coupler may hide it
      if (!found) continue;
      ++seen;
      EXPECT_LT((*found - pixel((*joints)[pivot], drawn.height_m)).norm(), 1.5) << "pivot " << pivot;
    }
  }
  EXPECT_GE(seen, 4) << model.name;
}

TEST(LinkageParts, joints_are_where_the_law_of_cosines_puts_them) {
  for (const calib::LinkagePreset& preset : calib::linkage_presets()) {
    expect_joints(calib::sweep_model_of_preset(preset.name));
  }
  expect_joints(falling_model());
  expect_joints(crossed_model());
}

}  // namespace
}  // namespace gdtslam
