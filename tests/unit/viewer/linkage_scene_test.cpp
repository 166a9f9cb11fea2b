// Pictures and films of a linkage: goldens, words that can be read, films that close.
#include <gtest/gtest.h>

#include <cmath>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/linkage_scene.hpp"
#include "support/image_compare.hpp"

namespace gdtslam {
namespace {

using namespace test;

calib::SweepModel double_rocker() {
  calib::SweepModel model;
  model.name = "swings";
  model.bars = {.crank_m = 0.08, .coupler_m = 0.04, .rocker_m = 0.07, .ground_m = 0.09};
  return model;
}

TEST(LinkageScene, goldens) {
  const GraphicsContext graphics;
  constexpr PictureSize kSize{320, 240};
  constexpr ImageTolerance kTolerance{.mean = 0.8, .share_clear = 0.006};
  LinkageScene paper(graphics, calib::sweep_model_of_preset("paper-b"), {.with_panel = false});
  const double crank_rad = paper.shown_crank_rad();
  EXPECT_TRUE(matches_golden(paper.render(crank_rad, kSize), "linkage_paper_b", kTolerance));
  LinkageScene swings(graphics, double_rocker(), {.is_dark = true, .with_panel = false});
  EXPECT_TRUE(matches_golden(swings.render(0.9, kSize), "linkage_double_rocker", kTolerance));

  const auto passes = [&](const RgbaImage& image) { return is_alike(image, golden("linkage_paper_b"), kTolerance); };
  EXPECT_FALSE(passes(paper.render(crank_rad + rad_from_deg(3.0), kSize))) << "three degrees on";
  LinkageScene other(graphics, calib::sweep_model_of_preset("paper-b-calibrated"), {.with_panel = false});
  EXPECT_FALSE(passes(other.render(crank_rad, kSize))) << "another linkage";
}

TEST(LinkageFilm, ends_where_it_began_without_a_jump) {
  const GraphicsContext graphics;
  constexpr PictureSize kSize{480, 270};
  constexpr std::size_t kFrames = 24;
  for (const calib::SweepModel& model : {calib::sweep_model_of_preset("paper-b"), double_rocker()}) {
    LinkageScene scene(graphics, model, {});
    const auto film = linkage_film(scene, model, kSize, kFrames);
    ASSERT_EQ(film->frames(), kFrames);
    std::vector<RgbaImage> frames;
    for (std::size_t k = 0; k < kFrames; ++k) frames.push_back(rasterise(film->frame(k)));
    EXPECT_EQ(rasterise(film->frame(kFrames)).pixels, frames.front().pixels) << model.name;
    double most = 0.0;
    for (std::size_t k = 1; k < kFrames; ++k) {
      const double step = difference_of(frames[k - 1], frames[k]).mean;
      EXPECT_GT(step, 0.0) << model.name << ", frame " << k;
      most = std::max(most, step);
    }
    EXPECT_LE(difference_of(frames.back(), frames.front()).mean, 1.5 * most) << model.name;
  }
}

}  // namespace
}  // namespace gdtslam
