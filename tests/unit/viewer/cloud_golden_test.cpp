// Whole pictures of a known room against goldens, and faults that must not pass for them.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "cloud_room.hpp"
#include "support/image_compare.hpp"

namespace gdtslam::test {
namespace {

const PictureSize kGoldenSize{160, 90};
const Bounds kRoom{Point3::Zero(), kRoomSize};
// Tighter than the default: the faults below differ by more.
const ImageTolerance kCloudTolerance{.mean = 0.5, .share_clear = 0.002, .clear_step = 24};

struct Subject {
  CloudLook look = plain_look();
  Camera camera = fitting_camera(CameraPreset::kIso, kRoom, kGoldenSize);
  bool with_path = true;
  bool with_robot = true;
};

RgbaImage picture_of(const Subject& subject) {
  static const Cloud cloud = room_cloud(400);
  const GraphicsContext graphics;
  CloudScene scene(graphics, subject.look);
  scene.set_cloud(cloud);
  if (subject.with_path) scene.set_trajectory(room_path());
  if (subject.with_robot) scene.set_robot(Pose2{.x_m = 3.2, .y_m = kPathY, .theta_rad = 0.0});
  return scene.render(subject.camera, kGoldenSize);
}

Subject iso_subject() {
  Subject subject;
  subject.camera = parse_camera("1.5,-1.4,5.2,3.7,3.1,0.3,38");  // near enough for the robot to be seen
  subject.look.with_eye_dome = true;
  subject.look.samples = 2;
  return subject;
}

Subject top_subject() {
  Subject subject;
  subject.look = plain_look(CloudColour::kElevation);
  subject.look.is_dark = false;
  subject.camera = fitting_camera(CameraPreset::kTop, kRoom, kGoldenSize);
  subject.with_robot = false;
  return subject;
}

void expect_fault_is_found(const Subject& good, const std::string& golden_name, const std::string& fault,
                           const std::function<void(Subject&)>& spoil) {
  Subject bad = good;
  spoil(bad);
  const RgbaImage image = picture_of(bad);
  const ImageDifference difference = difference_of(image, golden(golden_name), kCloudTolerance.clear_step);
  EXPECT_FALSE(is_alike(image, golden(golden_name), kCloudTolerance))
      << fault << ": mean " << difference.mean << ", share " << difference.share_clear;
}

// A step to the right by this share of the picture's width.
void shift(Camera& camera, double share) {
  const Point3 right = (camera.target - camera.eye).cross(camera.up).normalized();
  const double step_m = share * kGoldenSize.width / pixels_per_metre(camera, kGoldenSize, camera.target);
  camera.eye += step_m * right;
  camera.target += step_m * right;
}

TEST(CloudGolden, RoomOverItsWall) {
  const Subject good = iso_subject();
  ASSERT_TRUE(matches_golden(picture_of(good), "cloud_room_inside", kCloudTolerance));
  const auto expect_found = [&](const std::string& fault, const std::function<void(Subject&)>& spoil) {
    expect_fault_is_found(good, "cloud_room_inside", fault, spoil);
  };
  expect_found("another colour map", [](Subject& s) { s.look.colour_map = "ember"; });
  expect_found("another scale", [](Subject& s) { s.look.most = 3.0; });
  expect_found("a camera shifted by 2 %", [](Subject& s) { shift(s.camera, 0.02); });
  expect_found("a camera 2 % farther", [](Subject& s) { s.camera.eye += 0.02 * (s.camera.eye - s.camera.target); });
  expect_found("no path", [](Subject& s) { s.with_path = false; });
  expect_found("no robot", [](Subject& s) { s.with_robot = false; });
  expect_found("no eye-dome lighting", [](Subject& s) { s.look.with_eye_dome = false; });
  expect_found("no floor", [](Subject& s) { s.look.with_floor = false; });
  expect_found("a ceiling", [](Subject& s) { s.look.with_ceiling = true; });
  expect_found("a light page", [](Subject& s) { s.look.is_dark = false; });
}

TEST(CloudGolden, RoomFromAboveByElevation) {
  const Subject good = top_subject();
  ASSERT_TRUE(matches_golden(picture_of(good), "cloud_room_top", kCloudTolerance));
  const auto expect_found = [&](const std::string& fault, const std::function<void(Subject&)>& spoil) {
    expect_fault_is_found(good, "cloud_room_top", fault, spoil);
  };
  expect_found("another colour map", [](Subject& s) { s.look.colour_map = "lagoon"; });
  expect_found("another colour", [](Subject& s) { s.look.colour = CloudColour::kTime; });
  expect_found("no path", [](Subject& s) { s.with_path = false; });
  expect_found("a camera shifted by 2 %", [](Subject& s) { shift(s.camera, 0.02); });
  expect_found("a scale 2 % larger", [](Subject& s) { s.camera.parallel_height_m *= 0.98; });
  expect_found("upside down", [](Subject& s) { s.camera.up = -s.camera.up; });
}

}  // namespace
}  // namespace gdtslam::test
