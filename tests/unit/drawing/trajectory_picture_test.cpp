// Paths without a map: their colours, what lies over what, and scales that fit what is shown.
#include "engine/drawing/maps/map_pictures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

constexpr PictureSize kSheet{800, 600};
constexpr double kNoError = std::numeric_limits<double>::quiet_NaN();

/// Along x, 20 m.
Trajectory straight(double y_m = 0.0, int poses_per_m = 1) {
  Trajectory path;
  for (int k = 0; k <= 20 * poses_per_m; ++k) path.push_back({10.0 + k, {1.0 * k / poses_per_m, y_m, 0.0}});
  return path;
}

/// Colour of the line that ends in the middle of a stretch of the path, by its share of the path's length on the page.
std::vector<Colour> colours_along(const Canvas& canvas) {
  std::vector<Colour> colours;
  for (const shape::Line& line : shapes_of<shape::Line>(canvas)) colours.push_back(line.pen.colour);
  return colours;
}

bool has(const std::vector<Colour>& colours, Colour wanted) {
  for (const Colour& colour : colours) {
    const int off =
        std::abs(colour.red - wanted.red) + std::abs(colour.green - wanted.green) + std::abs(colour.blue - wanted.blue);
    if (off <= 24) return true;  // the middle of a band of 64 is two of a map's 256 colours from its end
  }
  return false;
}

TEST(TrajectoryPicture, ErrorsRunFromTheMapsFirstColourToItsLast) {
  const Trajectory truth = straight();
  const Trajectory path = straight(0.5);
  std::vector<double> errors;
  for (std::size_t k = 0; k < path.size(); ++k) errors.push_back(0.1 * static_cast<double>(k));
  const std::vector<std::size_t> drives;
  const PathErrors input{path, drives, errors, "Position error (m)", {}, {}};
  MapLook look;
  look.colour_map = "tide";
  const Canvas canvas = path_errors_picture(input, truth, look, kSheet);
  const std::vector<Colour> colours = colours_along(canvas);
  EXPECT_TRUE(has(colours, colour_map("tide").at(0.0)));
  EXPECT_TRUE(has(colours, colour_map("tide").at(0.5)));
  EXPECT_TRUE(says(canvas, "Position error (m)  0"));
  EXPECT_TRUE(says(canvas, "2"));
  const PathErrors farther{path, drives, errors, "Position error (m)", 0.0, 20.0};
  EXPECT_FALSE(has(colours_along(path_errors_picture(farther, truth, look, kSheet)), colour_map("tide").at(0.5)))
      << "of a scale ten times as long the path has but the first tenth";
}

TEST(TrajectoryPicture, PosesWithoutAnErrorAreGreyAndNoErrorAtAllIsRefused) {
  const Trajectory path = straight();
  std::vector<double> errors(path.size(), kNoError);
  const std::vector<std::size_t> drives;
  const PathErrors input{path, drives, errors, "Position error (m)", {}, {}};
  EXPECT_THROW(path_errors_picture(input, path, {}, kSheet), InputError);
  errors[0] = errors[1] = errors[2] = 0.3;
  EXPECT_TRUE(has(colours_along(path_errors_picture(input, path, {}, kSheet)), colour_for(0xc3c7cc)));
}

TEST(TrajectoryPicture, EachOfSeveralHasAColourAndAName) {
  const Trajectory truth = straight();
  const Canvas canvas =
      trajectories_picture({{"one", straight(0.4), {}}, {"other", straight(-0.4), {}}}, &truth, {}, kSheet);
  for (const char* name : {"truth", "one", "other"}) EXPECT_TRUE(says(canvas, name)) << name;
  const std::vector<Colour> colours = colours_along(canvas);
  EXPECT_TRUE(has(colours, kLightTheme.curve(0)));
  EXPECT_TRUE(has(colours, kLightTheme.curve(1)));
}

TEST(TrajectoryPicture, PathsOfNoLengthAndNoNumbersAreDrawn) {
  const Trajectory standing{{1.0, {2.0, 3.0, 0.0}}, {2.0, {2.0, 3.0, 0.0}}};
  EXPECT_NO_THROW(trajectory_picture({standing, {}, {}}, {}, size_for_paths({&standing})));
  const Trajectory lost{{1.0, {std::nan(""), 0.0, 0.0}}};
  EXPECT_NO_THROW(trajectory_picture({lost, {}, {}}, {}, size_for_paths({&lost})));
}

}  // namespace
}  // namespace gdtslam
