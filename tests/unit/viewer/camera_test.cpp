// Cameras against a projection that is written out as a matrix, and against what OpenGL draws.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/viewer/camera.hpp"

namespace gdtslam::test {
namespace {

// Pixel by OpenGL's own way: a look-at and a projection matrix, division by w, viewport.
Point2 matrix_pixel(const Camera& camera, const PictureSize& size, const Point3& point) {
  const Point3 back = (camera.eye - camera.target).normalized();
  const Point3 right = camera.up.cross(back).normalized();
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.block<1, 3>(0, 0) = right.transpose();
  view.block<1, 3>(1, 0) = back.cross(right).transpose();
  view.block<1, 3>(2, 0) = back.transpose();
  view.block<3, 1>(0, 3) = -view.block<3, 3>(0, 0) * camera.eye;
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  if (camera.is_parallel) {
    projection(0, 0) = 2.0 / (camera.parallel_height_m * size.aspect());
    projection(1, 1) = 2.0 / camera.parallel_height_m;
    projection(3, 3) = 1.0;
  } else {
    projection(1, 1) = 1.0 / std::tan(0.5 * camera.view_angle_rad);
    projection(0, 0) = projection(1, 1) / size.aspect();
    projection(3, 2) = -1.0;
  }
  const Eigen::Vector4d clip = projection * view * Eigen::Vector4d(point.x(), point.y(), point.z(), 1.0);
  return {0.5 * size.width * (1.0 + clip.x() / clip.w()), 0.5 * size.height * (1.0 - clip.y() / clip.w())};
}

std::vector<Point3> box_corners(const Bounds& box) {
  std::vector<Point3> corners;
  for (int k = 0; k < 8; ++k) {
    corners.emplace_back((k & 1 ? box.highest : box.lowest).x(), (k & 2 ? box.highest : box.lowest).y(),
                         (k & 4 ? box.highest : box.lowest).z());
  }
  return corners;
}

// Least distance of the box's corners to each edge of the picture, as a share of its side: left, right, top, bottom.
std::array<double, 4> margins(const Camera& camera, const PictureSize& size, const Bounds& box) {
  std::array<double, 4> least{1.0, 1.0, 1.0, 1.0};
  for (const Point3& corner : box_corners(box)) {
    const Point2 at = matrix_pixel(camera, size, corner);
    const double x = at.x() / size.width;
    const double y = at.y() / size.height;
    least = {std::min(least[0], x), std::min(least[1], 1.0 - x), std::min(least[2], y), std::min(least[3], 1.0 - y)};
  }
  return least;
}

const std::vector<Bounds> kBoxes{{{-2.0, -8.0, 0.0}, {34.0, 8.0, 2.6}},
                                 {{0.0, 0.0, 0.0}, {3.0, 40.0, 5.0}},
                                 {{-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}},
                                 {{5.0, 5.0, 0.0}, {6.0, 6.0, 30.0}},
                                 {{1e4, -1e4, 3.0}, {1e4 + 50.0, -1e4 + 50.0, 3.0}}};
const std::vector<PictureSize> kSizes{{1280, 720}, {480, 270}, {600, 1200}, {100, 100}};

TEST(Camera, PixelsAreThoseOfTheProjectionMatrix) {
  Random random(7);
  const auto anywhere = [&random] {
    return Point3(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
  };
  int seen_count = 0;
  for (int k = 0; k < 500; ++k) {
    Camera camera{.eye = anywhere(), .target = anywhere(), .up = anywhere().normalized()};
    camera.is_parallel = k % 3 == 0;
    camera.view_angle_rad = random.uniform(0.1, 2.0);
    camera.parallel_height_m = random.uniform(1.0, 20.0);
    const PictureSize size = kSizes[static_cast<std::size_t>(k) % kSizes.size()];
    const Point3 point = anywhere();
    const double depth_m = (camera.target - camera.eye).normalized().dot(point - camera.eye);
    const auto seen = project(camera, size, point);
    ASSERT_EQ(seen.has_value(), depth_m > 0.0);
    if (!seen) continue;
    ++seen_count;
    const Point2 expected = matrix_pixel(camera, size, point);
    const double tolerance = 1e-9 * (1.0 + expected.norm());
    EXPECT_NEAR(seen->x(), expected.x(), tolerance);
    EXPECT_NEAR(seen->y(), expected.y(), tolerance);
  }
  EXPECT_GT(seen_count, 150);
}

TEST(FittingCamera, BoxFillsThePictureUpToTheMargin) {
  for (const Bounds& box : kBoxes) {
    for (const PictureSize& size : kSizes) {
      for (const CameraPreset preset :
           {CameraPreset::kIso, CameraPreset::kTop, CameraPreset::kFront, CameraPreset::kSide}) {
        const auto [left, right, top, bottom] = margins(fitting_camera(preset, box, size), size, box);
        const double tolerance = 1e-7;
        for (const double margin : {left, right, top, bottom}) EXPECT_GE(margin, 0.06 - tolerance);
        const bool fills_width = left < 0.06 + tolerance && right < 0.06 + tolerance;
        const bool fills_height = top < 0.06 + tolerance && bottom < 0.06 + tolerance;
        EXPECT_TRUE(fills_width || fills_height)
            << left << " " << right << " " << top << " " << bottom << " preset " << static_cast<int>(preset);
        EXPECT_NEAR(left, right, tolerance) << "in the middle";
        EXPECT_NEAR(top, bottom, tolerance) << "in the middle";
      }
    }
  }
}

TEST(OrbitCamera, BoxStaysInThePictureAllTheWayRound) {
  for (const Bounds& box : kBoxes) {
    for (const PictureSize& size : kSizes) {
      const Camera camera = orbit_camera(box, size);
      EXPECT_NEAR((camera.target - box.centre()).head<2>().norm(), 0.0, 1e-6) << "turns about the box's axis";
      double nearest = 1.0;
      for (int degree = 0; degree < 360; ++degree) {
        for (const double margin : margins(turned(camera, degree * std::numbers::pi / 180.0), size, box)) {
          nearest = std::min(nearest, margin);
        }
      }
      EXPECT_GE(nearest, 0.015);
      EXPECT_LE(nearest, 0.03) << "as near as that allows";
    }
  }
}

TEST(CameraText, NumbersMeanWhatTheFormSays) {
  const Camera camera = parse_camera("1,2,3,4,5,6,90");
  EXPECT_EQ(camera.eye, Point3(1, 2, 3));
  EXPECT_EQ(camera.target, Point3(4, 5, 6));
  EXPECT_NEAR(camera.view_angle_rad, 0.5 * std::numbers::pi, 1e-15);
  EXPECT_EQ(camera.up, Point3::UnitZ());
  EXPECT_EQ(parse_camera("1,2,30,1,2,0").up, Point3::UnitY()) << "straight down";
  EXPECT_EQ(parse_camera("1,2,3,4,5,6").view_angle_rad, Camera{}.view_angle_rad);
}

TEST(CameraText, WrongCamerasAreRefused) {
  for (const char* text : {"", "1,2,3", "1,2,three,4,5,6", "1,2,inf,4,5,6", "1,2,3e7,4,5,6", "1,2,3,1,2,3",
                           "1,2,3,4,5,6,0", "1,2,3,4,5,6,0m"}) {
    EXPECT_THROW(parse_camera(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace gdtslam::test
