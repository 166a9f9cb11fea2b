// The film of a scanning robot: points until each moment, the sensor where it was, frames that differ.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/linkage/linkage_cycle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/film.hpp"
#include "scanning_room.hpp"
#include "support/image_compare.hpp"
#include "support/picture_scene.hpp"
#include "viewer/scene/scan/scanning_scene.hpp"

namespace gdtslam {
namespace {

using namespace test;

CloudLook quick_look() {
  CloudLook look;
  look.samples = 1;
  return look;
}

TEST(ScanningScene, draws_the_points_that_were_measured_until_then) {
  const GraphicsContext graphics;
  const ScanningRoom room;
  const Cloud cloud = room.cloud();
  const Trajectory trajectory = room.trajectory();
  const ScanningTrack track(cloud, trajectory, 1.0, 6.0);
  ScanningScene scene(graphics, track, room.model, true, trajectory, quick_look());
  for (const double stamp_s : {1.0, 1.5, 3.21, 6.0}) {
    scene.show(stamp_s, room.crank_rad(stamp_s));
    const auto truth = std::count_if(cloud.begin(), cloud.end(), [&](const CloudPoint& point) {
      return point.stamp_s >= 1.0 && point.stamp_s <= stamp_s;
    });
    EXPECT_EQ(scene.points_drawn(), static_cast<std::uint64_t>(truth)) << stamp_s;
  }
}

TEST(ScanningScene, sensor_is_where_it_was_and_looks_along_the_elevation) {
  const GraphicsContext graphics;
  ScanningRoom room;
  room.sensor_forward_m = 0.12;
  const Cloud cloud = room.cloud();
  const Trajectory trajectory = room.trajectory();
  const ScanningTrack track(cloud, trajectory, 0.0, room.length_s);
  ScanningScene scene(graphics, track, room.model, true, trajectory, quick_look());
  for (const double stamp_s : {0.5, 2.0, 3.9}) {
    scene.show(stamp_s, room.crank_rad(stamp_s));
    const Pose3 T_map_laser = scene.T_map_laser();
    const Pose2 base = room.T_map_base(stamp_s);
    EXPECT_NEAR(T_map_laser.translation_m.x(), base.x_m + 0.12 * std::cos(room.heading_rad), 1e-3);
    EXPECT_NEAR(T_map_laser.translation_m.y(), base.y_m + 0.12 * std::sin(room.heading_rad), 1e-3);
    EXPECT_NEAR(T_map_laser.translation_m.z(), room.model.mount.height_m, 1e-9);
    // The middle beam's point of that very moment lies along the sensor's forward direction.
    const CloudPoint ahead = room.measured(stamp_s, 0.0, 0);
    const Point3 along = T_map_laser * Point3(2.5, 0.0, 0.0);
    EXPECT_NEAR(along.x(), ahead.x_m, 2e-3);
    EXPECT_NEAR(along.y(), ahead.y_m, 2e-3);
    EXPECT_NEAR(along.z(), ahead.z_m, 2e-3);
  }
}

/// The whole drive through the round room.
struct WholeDrive {
  [[nodiscard]] std::unique_ptr<Film> film(const std::string& subtitle, const PictureSize& size,
                                           std::size_t frames) const {
    const ScanningFilmInput input{
        .cloud = &cloud, .trajectory = &trajectory, .model = &room.model, .from_s = 0.0, .to_s = room.length_s};
    CloudCaption caption;
    caption.title = "round room";
    caption.subtitle = subtitle;
    return scanning_film(graphics, input, quick_look(), caption, size, frames);
  }
  GraphicsContext graphics;
  ScanningRoom room;
  Cloud cloud = room.cloud();
  Trajectory trajectory = room.trajectory();
};

TEST(ScanningFilm, runs_through_the_stretch) {
  const WholeDrive drive;
  const auto film = drive.film("", {640, 360}, 5);
  ASSERT_EQ(film->frames(), 5U);
  const Canvas first = film->frame(0);
  const Canvas last = film->frame(4);
  EXPECT_TRUE(has_words(first, "round room"));
  EXPECT_TRUE(has_words(first, "1")) << "the beam at 0 s";
  EXPECT_TRUE(has_words(last, "57,920")) << "320 scans of 181 beams";
  EXPECT_TRUE(has_words(last, "8.0 s"));
  const RgbaImage start = rasterise(first);
  const RgbaImage end = rasterise(last);
  EXPECT_EQ(start.width, 640U);
  EXPECT_EQ(start.height, 360U);
  EXPECT_GT(difference_of(start, end).share_clear, 0.05);
  EXPECT_EQ(rasterise(film->frame(0)).pixels, start.pixels) << "any order of frames gives the same";
}

TEST(ScanningFilm, words_are_legible_and_apart) {
  const WholeDrive drive;
  for (const PictureSize& size : {PictureSize{1280, 720}, PictureSize{640, 360}, PictureSize{480, 640}}) {
    const auto film = drive.film("57,920 points", size, 3);
    for (const std::size_t k : {0U, 1U, 2U}) expect_tidy(film->frame(k), std::to_string(size.width));
  }
}

}  // namespace
}  // namespace gdtslam
