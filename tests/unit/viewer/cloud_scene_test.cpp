// Pictures of clouds whose points are known: where they appear, what covers what, what is taken away.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "cloud_room.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::test {
namespace {

const PictureSize kSceneSize{320, 180};

class CloudSceneTest : public ::testing::Test {
 protected:
  GraphicsContext graphics_;
};

Camera over_the_room() { return fitting_camera(CameraPreset::kTop, {Point3::Zero(), kRoomSize}, kSceneSize); }

TEST_F(CloudSceneTest, APointAppearsAtItsPixelForEveryKindOfCamera) {
  Camera tilted = parse_camera("-7,4,9,1,2,0.5,50");
  tilted.up = Point3(0.3, 0.1, 1.0).normalized();
  const Bounds box{{-3.0, -3.0, 0.0}, {4.0, 4.0, 2.0}};
  for (const Camera& camera : {tilted, fitting_camera(CameraPreset::kIso, box, kSceneSize),
                               fitting_camera(CameraPreset::kTop, box, kSceneSize), parse_camera("3,-6,2,1,1,1,5m")}) {
    for (const Point3& place : {Point3(1.0, 2.0, 0.5), Point3(2.0, 1.0, 0.0), Point3(0.2, 1.5, 1.0)}) {
      for (const std::uint32_t samples : {1U, 2U}) {
        CloudLook look = plain_look(CloudColour::kPlain);
        look.samples = samples;
        CloudScene scene(graphics_, look);
        const Cloud cloud{test::cloud_point(place)};
        scene.set_cloud(cloud);
        const RgbaImage image = scene.render(camera, kSceneSize);
        double x = 0.0;
        double y = 0.0;
        double weight = 0.0;
        for (std::uint32_t row = 0; row < image.height; ++row) {
          for (std::uint32_t column = 0; column < image.width; ++column) {
            const double light = std::max(0, image.at(column, row)[0] - ink::kNight.red);
            x += light * (column + 0.5);
            y += light * (row + 0.5);
            weight += light;
          }
        }
        ASSERT_GT(weight, 0.0);
        const auto expected = project(camera, kSceneSize, place);
        ASSERT_TRUE(expected.has_value());
        EXPECT_NEAR(x / weight, expected->x(), 0.75 / samples);
        EXPECT_NEAR(y / weight, expected->y(), 0.75 / samples);
      }
    }
  }
}

TEST_F(CloudSceneTest, FloorAndCeilingAreTakenAwayAsAsked) {
  const Cloud cloud = room_cloud();
  const auto with = [&](bool floor, bool ceiling) {
    CloudLook look = plain_look();
    look.with_floor = floor;
    look.with_ceiling = ceiling;
    CloudScene scene(graphics_, look);
    scene.set_cloud(cloud);
    return std::pair(scene.points_drawn(), scene.render(over_the_room(), kSceneSize));
  };
  // What is drawn is counted by height, with the margins given in the sources' own comments left aside.
  const auto between = [&](float low, float high) {
    return static_cast<double>(std::count_if(
        cloud.begin(), cloud.end(), [&](const CloudPoint& point) { return point.z_m > low && point.z_m < high; }));
  };
  const auto all = with(true, true);
  EXPECT_EQ(all.first, cloud.size());
  const auto no_ceiling = with(true, false);
  EXPECT_GE(static_cast<double>(no_ceiling.first), between(-1.0F, 2.2F));
  EXPECT_LE(static_cast<double>(no_ceiling.first), between(-1.0F, 2.45F));
  const auto neither = with(false, false);
  EXPECT_GE(static_cast<double>(neither.first), between(0.1F, 2.2F));
  EXPECT_LE(static_cast<double>(neither.first), between(0.03F, 2.45F));
  // From above: the ceiling is yellow, the floor blue, without both the background is seen.
  const ColourMap& map = colour_map("lagoon");
  const auto pixel = [](const RgbaImage& image, const Point3& at) {
    const auto seen = project(over_the_room(), kSceneSize, at);
    return image.at(static_cast<std::uint32_t>(seen->x()), static_cast<std::uint32_t>(seen->y()));
  };
  const Point3 free_place(2.5, 2.5, 0.0);
  EXPECT_TRUE(is_colour(pixel(all.second, free_place), map.at(1.0), 6));
  EXPECT_TRUE(is_colour(pixel(no_ceiling.second, free_place), map.at(0.0), 6));
  EXPECT_TRUE(is_colour(pixel(neither.second, free_place), ink::kNight));
  EXPECT_FALSE(is_colour(pixel(neither.second, {5.5, 3.0, 0.9}), ink::kNight)) << "the box stays";
  // The share of the picture that the floor covers: the room less walls and box.
  const double scale_px = pixels_per_metre(over_the_room(), kSceneSize, Point3::Zero());
  const double floor_px = (8.0 * 5.0 - 1.2 * 0.8) * scale_px * scale_px;
  const double lost = static_cast<double>(covered(no_ceiling.second, ink::kNight)) -
                      static_cast<double>(covered(neither.second, ink::kNight));
  EXPECT_NEAR(lost, floor_px, 0.06 * floor_px);
}

TEST_F(CloudSceneTest, ShowUntilDrawsWhatWasMeasuredTillThenInAnyOrder) {
  Cloud cloud = room_cloud(1500);
  ASSERT_GT(cloud.size(), 131072U) << "more than two pieces";
  for (std::size_t k = 0; k < cloud.size(); ++k) std::swap(cloud[k], cloud[k * 7919 % cloud.size()]);
  CloudLook look = plain_look();
  look.with_ceiling = true;
  CloudScene scene(graphics_, look);
  scene.set_cloud(cloud);
  for (const double stamp_s : {99.0, 100.0, 100.0005, 123.456, 165.536, 165.5365, 200.0, 1e9,
                               std::numeric_limits<double>::infinity(), 111.0}) {
    scene.show_until(stamp_s);
    const auto expected =
        std::count_if(cloud.begin(), cloud.end(), [&](const CloudPoint& point) { return point.stamp_s <= stamp_s; });
    EXPECT_EQ(scene.points_drawn(), static_cast<std::uint64_t>(expected)) << stamp_s;
  }
  // The floor comes first: its points alone give the picture of a cloud that is nothing else.
  const auto floor_count = static_cast<std::size_t>(8.0 * 5.0 * 1500);
  const double floor_end_s = 100.0 + 0.001 * (static_cast<double>(floor_count) - 0.5);
  scene.show_until(floor_end_s);
  EXPECT_EQ(scene.points_drawn(), floor_count);
  const RgbaImage half = scene.render(over_the_room(), kSceneSize);
  const auto at = project(over_the_room(), kSceneSize, {5.5, 3.0, 0.0});
  EXPECT_TRUE(is_colour(half.at(static_cast<std::uint32_t>(at->x()), static_cast<std::uint32_t>(at->y())),
                        colour_map("lagoon").at(0.0), 6));
  scene.show_until(0.0);
  EXPECT_EQ(covered(scene.render(over_the_room(), kSceneSize), ink::kNight), 0U);
}

TEST_F(CloudSceneTest, BoundsLeaveStrayPointsOutAndTakeThePathIn) {
  Cloud cloud = room_cloud();
  Random random(1);
  test::strew_outliers(cloud, {0.0, 0.0, 0.0}, 500.0, 20, random);
  CloudLook look = plain_look();
  look.with_ceiling = true;
  CloudScene scene(graphics_, look);
  EXPECT_TRUE(scene.bounds().is_empty());
  scene.set_cloud(cloud);
  EXPECT_NEAR((scene.bounds().lowest - Point3::Zero()).cwiseAbs().maxCoeff(), 0.0, 0.05);
  EXPECT_NEAR((scene.bounds().highest - kRoomSize).cwiseAbs().maxCoeff(), 0.0, 0.05);
  scene.set_trajectory({{.stamp_s = 0.0, .T_map_base = {.x_m = -9.0, .y_m = 2.0, .theta_rad = 0.0}}});
  EXPECT_NEAR(scene.bounds().lowest.x(), -9.0, 1e-9);
}

TEST_F(CloudSceneTest, WhatCannotBeShownIsSaid) {
  CloudScene scene(graphics_, plain_look());
  EXPECT_THROW(scene.set_cloud({}), InputError);
  Cloud nowhere(3, test::cloud_point({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}));
  EXPECT_THROW(scene.set_cloud(nowhere), InputError);
  CloudScene by_distance(graphics_, plain_look(CloudColour::kDistance));
  EXPECT_THROW(by_distance.set_cloud(room_cloud(50)), InputError);
  Cloud some = room_cloud(50);
  some[3].y_m = std::numeric_limits<float>::infinity();
  CloudLook look = plain_look();
  look.with_ceiling = true;
  CloudScene rest(graphics_, look);
  rest.set_cloud(some);
  EXPECT_EQ(rest.points_drawn(), some.size() - 1);
}

}  // namespace
}  // namespace gdtslam::test
