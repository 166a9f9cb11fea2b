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

/// Share of a ray from the axis, beyond the bars, that has the beams' colour.
double beam_share(const RgbaImage& image, double angle_rad, double from_px, double to_px) {
  int hits = 0;
  int count = 0;
  for (double away = from_px; away < to_px; away += 1.0) {
    const auto x = static_cast<std::uint32_t>(0.5 * kPartsSize.width + away * std::cos(angle_rad));
    const auto y = static_cast<std::uint32_t>(0.5 * kPartsSize.height - away * std::sin(angle_rad));
    bool is_beam = false;
    for (const std::uint32_t dx : {0U, 1U, 2U}) {
      for (const std::uint32_t dy : {0U, 1U, 2U}) {
        const std::uint8_t* at = image.at(x + dx - 1, y + dy - 1);
        is_beam = is_beam || at[0] > at[2] + 40;
      }
    }
    hits += is_beam ? 1 : 0;
    ++count;
  }
  return static_cast<double>(hits) / count;
}

TEST(LinkageParts, fan_lies_at_the_elevation) {
  for (const calib::SweepModel& model : {calib::sweep_model_of_preset("paper-b"), falling_model()}) {
    Drawn drawn(model);
    drawn.parts.add_to(drawn.view.renderer());
    drawn.parts.show(false);
    drawn.parts.show_fan(true);
    const double scale = kPartsSize.height / drawn.height_m;
    for (const double crank_rad : {1.0, 2.5, 4.0, 5.5}) {
      const RgbaImage image = drawn.at(crank_rad);
      const double elevation_deg = *calib::elevation_rad(model, crank_rad) * 180.0 / M_PI;
      // Seen from the side the fan is a line from the sensor.
      for (double away_deg = -180.0; away_deg < 180.0; away_deg += 3.0) {
        const double share =
            beam_share(image, (elevation_deg + away_deg) * M_PI / 180.0, 0.5 * drawn.parts.sizes().fan_m * scale,
                       0.95 * drawn.parts.sizes().fan_m * scale);
        if (away_deg == 0.0) {
          EXPECT_GT(share, 0.95) << "crank " << crank_rad;
        } else {
          EXPECT_LT(share, 0.2) << "crank " << crank_rad << ", " << away_deg << " degrees away";
        }
      }
    }
  }
}

TEST(LinkageParts, dead_points_are_marked_where_the_rocker_turns_back) {
  for (const char* preset : {"paper-a", "paper-b", "paper-c"}) {
    Drawn drawn(calib::sweep_model_of_preset(preset));
    const calib::LinkageCycle cycle(drawn.model);
    const LinkageSurroundings surroundings(cycle, drawn.parts, colour_for(0xffffff));
    surroundings.add_to(drawn.view.renderer());
    const RgbaImage image = drawn.view.render(side_camera(drawn.height_m), kPartsSize);
    const calib::CrankRockerReport report = calib::analyse(drawn.model.bars, drawn.model.assembly);
    for (const calib::DeadPoint& dead : {report.lowest, report.highest}) {
      const double angle = drawn.model.elevation_sign * dead.rocker_rad + drawn.model.elevation_offset_rad;
      const Point2 at = pixel(drawn.model.bars.rocker_m * Point2(std::cos(angle), std::sin(angle)), drawn.height_m);
      const auto is_mark = [&](const Point2& place) {
        const std::uint8_t* colour =
            image.at(static_cast<std::uint32_t>(place.x()), static_cast<std::uint32_t>(place.y()));
        return std::min({colour[0], colour[1], colour[2]}) > 110;
      };
      EXPECT_TRUE(is_mark(at)) << preset << " at " << at.transpose();
      const double radius_px = 0.55 * drawn.parts.sizes().bar_m * kPartsSize.height / drawn.height_m;
      for (const Point2& aside : {Point2(1.6, 0.0), Point2(-1.6, 0.0), Point2(0.0, 1.6), Point2(0.0, -1.6)}) {
        EXPECT_FALSE(is_mark(at + radius_px * aside)) << preset << " beside " << at.transpose();
      }
    }
  }
}

}  // namespace
}  // namespace gdtslam
