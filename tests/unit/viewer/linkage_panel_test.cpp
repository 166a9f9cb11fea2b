// Words beside a linkage: all there, large enough, none over another or over the edge; the marks run along.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/viewer/linkage_scene.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

std::vector<calib::SweepModel> models() {
  std::vector<calib::SweepModel> models;
  for (const calib::LinkagePreset& preset : calib::linkage_presets()) {
    models.push_back(calib::sweep_model_of_preset(preset.name));
  }
  calib::SweepModel odd;
  odd.name = "a-name-of-some-length-as-files-have-it";
  odd.bars = {.crank_m = 3.71234, .coupler_m = 2.91234, .rocker_m = 4.07771, .ground_m = 5.01234};
  models.push_back(odd);
  odd.name = "";
  odd.bars = {.crank_m = 0.07, .coupler_m = 0.06, .rocker_m = 0.08, .ground_m = 0.03};
  models.push_back(odd);
  return models;
}

TEST(LinkagePanel, words_are_legible_and_apart) {
  const GraphicsContext graphics;
  for (const calib::SweepModel& model : models()) {
    LinkageScene scene(graphics, model, {.samples = 1});
    for (const PictureSize& size :
         {PictureSize{1280, 720}, PictureSize{640, 360}, PictureSize{600, 800}, PictureSize{480, 270}}) {
      for (const double turn : {0.0, 2.3}) {
        const Canvas canvas = scene.picture(scene.shown_crank_rad() + turn, size);
        EXPECT_GT(shapes_of<shape::Words>(canvas).size(), 10U);
        expect_tidy(canvas, model.name + " " + std::to_string(size.width));
      }
    }
  }
}

TEST(LinkagePanel, reads_out_the_angles_as_they_are) {
  const GraphicsContext graphics;
  const calib::SweepModel model = calib::sweep_model_of_preset("paper-b");
  LinkageScene scene(graphics, model, {.samples = 1});
  // At the lowest dead point by the law of cosines: coupler and crank stretched, elevation 0.
  const double reach = model.bars.coupler_m + model.bars.crank_m;
  const double crank_deg = deg_from_rad(std::acos(
      (reach * reach + model.bars.ground_m * model.bars.ground_m - model.bars.rocker_m * model.bars.rocker_m) /
      (2.0 * reach * model.bars.ground_m)));
  const Canvas canvas = scene.picture(rad_from_deg(crank_deg), {1280, 720});
  char text[16];
  std::snprintf(text, sizeof text, "%.1f°", crank_deg);
  EXPECT_TRUE(has_words(canvas, text)) << text;
  EXPECT_TRUE(has_words(canvas, "0.0°"));
  for (const char* words : {"paper-b", "3.6 cm", "8.5 cm", "8.8 cm", "5 cm", "lift 266.4°", "return 93.6°"}) {
    EXPECT_TRUE(has_words(canvas, words)) << words;
  }
}

}  // namespace
}  // namespace gdtslam
