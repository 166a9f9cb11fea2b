// Films of a cloud: that they close, grow and end as they should, and leave the scene as it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <vector>

#include "cloud_room.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/viewer/film.hpp"
#include "support/image_compare.hpp"

namespace gdtslam::test {
namespace {

const PictureSize kFilmSize{160, 90};
const CloudCaption kBareCaption{.title = "", .subtitle = "", .with_bars = false};

std::shared_ptr<const RgbaImage> scene_of(const Canvas& frame) {
  for (const Shape& shape : frame.shapes()) {
    if (const auto* picture = std::get_if<shape::Picture>(&shape)) return picture->image;
  }
  return nullptr;
}

class CloudFilmTest : public ::testing::Test {
 protected:
  CloudFilmTest() : cloud_(room_cloud(300)), look_(plain_look()), scene_(graphics_, look_) { scene_.set_cloud(cloud_); }
  GraphicsContext graphics_;
  Cloud cloud_;
  CloudLook look_;
  CloudScene scene_;
};

TEST_F(CloudFilmTest, OrbitClosesWithoutAJump) {
  const std::size_t count = 24;
  const auto film = orbit_film(scene_, look_, kBareCaption, kFilmSize, count);
  ASSERT_EQ(film->frames(), count);
  std::vector<std::shared_ptr<const RgbaImage>> frames;
  for (std::size_t k = 0; k < count; ++k) frames.push_back(scene_of(film->frame(k)));
  std::vector<double> steps;
  for (std::size_t k = 0; k < count; ++k) {
    steps.push_back(difference_of(*frames[k], *frames[(k + 1) % count]).mean);
  }
  for (const double step : steps) EXPECT_GT(step, 1.0) << "each frame is another picture";
  const double largest = *std::max_element(steps.begin(), steps.end() - 1);
  EXPECT_LE(steps.back(), 1.15 * largest) << "from the last to the first no more than elsewhere";
  EXPECT_EQ(scene_of(film->frame(0))->pixels, frames[0]->pixels) << "frames may be asked for in any order";
}

TEST_F(CloudFilmTest, FollowFilmGrowsAndEndsWithAllMeasuredTillThen) {
  const Trajectory path = room_path();
  scene_.set_trajectory(path);
  const auto whole = scene_.points_drawn();
  const RgbaImage before = scene_.render(fitting_camera(CameraPreset::kTop, scene_.bounds(), kFilmSize), kFilmSize);
  {
    const auto film = follow_film(scene_, path, look_, kBareCaption, kFilmSize, 6);
    std::uint64_t last = 0;
    for (std::size_t k = 0; k < film->frames(); ++k) {
      const Canvas frame = film->frame(k);
      EXPECT_EQ(scene_of(frame)->width, kFilmSize.width);
      const double stamp_s = 100.0 + 100.0 * static_cast<double>(k) / 5.0;
      std::uint64_t expected = 0;
      for (const CloudPoint& point : cloud_) {
        if (point.stamp_s <= stamp_s && point.z_m < 2.25F) ++expected;
      }
      EXPECT_NEAR(static_cast<double>(scene_.points_drawn()), static_cast<double>(expected),
                  0.01 * static_cast<double>(whole));
      EXPECT_GE(scene_.points_drawn(), last);
      last = scene_.points_drawn();
    }
  }
  EXPECT_EQ(scene_.points_drawn(), whole) << "the scene is as it was";
  const RgbaImage after = scene_.render(fitting_camera(CameraPreset::kTop, scene_.bounds(), kFilmSize), kFilmSize);
  EXPECT_EQ(after.pixels, before.pixels);
}

// Stamps that jitter are none that a clock was set back by.
TEST_F(CloudFilmTest, AClockThatWasSetBackCannotBeFollowed) {
  Trajectory path = room_path();
  const auto film = [&] { return follow_film(scene_, path, look_, kBareCaption, kFilmSize, 2)->frame(1); };
  for (std::size_t k = 1; k < path.size(); k += 2) path[k].stamp_s = path[k - 1].stamp_s - 0.01;
  EXPECT_NO_THROW(film());
  for (std::size_t k = path.size() / 2; k < path.size(); ++k) path[k].stamp_s -= 500.0;
  EXPECT_THROW(film(), InputError);
  path = {{10.0, {1.0, kPathY, 0.0}}, {9.5, {2.0, kPathY, 0.0}}};
  EXPECT_THROW(film(), InputError);
}

}  // namespace
}  // namespace gdtslam::test
