// Pictures of scenes whose every pixel follows from the camera's definition.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gdtslam/core/error.hpp"
#include "graphics_scene.hpp"

namespace gdtslam::test {
namespace {

class OffscreenViewTest : public ::testing::Test {
 protected:
  GraphicsContext graphics_;
};

TEST_F(OffscreenViewTest, TransparentWhereNothingIsAndColoursNotPremultiplied) {
  OffscreenView view(graphics_);
  add_shape(view, upright_square({0.0, 10.0, 0.0}, 1.0), kRed, 0.5);
  view.set_background(kGreen, true);
  const RgbaImage image = view.render(camera_along_y(true), {120, 120});
  EXPECT_EQ(image.at(5, 5)[3], 0);
  EXPECT_EQ(image.at(5, 5)[1], 0) << "no colour of the background where it is transparent";
  EXPECT_NEAR(image.at(60, 60)[3], 128, 1);
  EXPECT_TRUE(is_near(image.at(60, 60), kRed, 3));
}

// The square's edge lies 20.25 pixels from the centre: a quarter of that pixel is covered.
TEST_F(OffscreenViewTest, SamplesGiveEdgesTheirShare) {
  OffscreenView view(graphics_);
  view.set_samples(4);
  add_shape(view, upright_square({0.0, 10.0, 0.0}, 20.25 / 20.0), kRed);
  view.set_background(kGreen, true);
  const RgbaImage clear = view.render(camera_along_y(true), {120, 120});
  EXPECT_EQ(clear.at(79, 60)[3], 255);
  EXPECT_EQ(clear.at(80, 60)[3], 64);
  EXPECT_EQ(clear.at(81, 60)[3], 0);
  EXPECT_TRUE(is_near(clear.at(80, 60), kRed, 1)) << "the edge has the square's own colour";
  view.set_background(kGreen, false);
  const RgbaImage covered = view.render(camera_along_y(true), {120, 120});
  EXPECT_NEAR(covered.at(80, 60)[0], 0.25 * kRed.red + 0.75 * kGreen.red, 1.0);
  EXPECT_NEAR(covered.at(80, 60)[1], 0.25 * kRed.green + 0.75 * kGreen.green, 1.0);
  EXPECT_EQ(covered.at(80, 60)[3], 255);
}

// Laser and camera both miss a wall at times; the room is drawn for all that.
TEST_F(OffscreenViewTest, OneStrayPointFarOutTakesNothingAway) {
  const PictureSize size{200, 200};
  for (const Point3& stray : {Point3(0.0, 30000.0, 0.0), Point3(30000.0, 9.0, 0.0), Point3(0.0, -1e6, 20.0)}) {
    OffscreenView view(graphics_);
    add_shape(view, {Point3(0.4, 8.0, 0.3)}, kGreen);
    add_shape(view, {stray}, kRed);
    EXPECT_GT(spot_of(view.render(camera_along_y(false), size), kGreen).count, 10.0) << stray.transpose();
  }
}

TEST_F(OffscreenViewTest, RefusesWhatCannotBeDrawn) {
  OffscreenView view(graphics_);
  EXPECT_THROW(view.render(Camera{}, {10, 4'000'000}), UsageError);
  EXPECT_EQ(view.render(Camera{}, {10, 10}).width, 10U) << "usable after refusals";
}

TEST_F(OffscreenViewTest, WhatVtkSaysReachesTheCaller) {
  OffscreenView view(graphics_);
  vtkActor* actor = add_shape(view, {{0.0, 0.0, 0.0}}, kRed);
  ::testing::internal::CaptureStderr();
  vtkWarningWithObjectMacro(actor, "an odd\n  thing");
  vtkErrorWithObjectMacro(actor, "a bad\n  thing");
  try {
    view.render(Camera{}, {20, 20});
    FAIL() << "an error of VTK was swallowed";
  } catch (const DeviceError& error) {
    EXPECT_THAT(error.what(), ::testing::EndsWith("a bad thing"));
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(view.render(Camera{}, {20, 20}).width, 20U) << "an error is thrown once";
}

}  // namespace
}  // namespace gdtslam::test
