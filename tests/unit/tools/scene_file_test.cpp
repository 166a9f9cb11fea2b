// Scene files: what is read, and one clear line for what cannot be.
#if __has_include("gdtslam/sim/scene.hpp")  // the simulator may be left out of a build

#include "tools/gdtslam/scenes/scene_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

class SceneFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("scene_file_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  // The message for a scene whose lines after the first are given; it begins with the file's name and a line.
  std::string refusal(const std::string& lines) const {
    const std::string path = write("s.yaml", "gdtslam_scene: 1\n" + lines);
    try {
      read_scene(path);
    } catch (const ConfigError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_EQ(message.find(path + ":"), 0U) << message;
      return message.substr(path.size() + 1);
    }
    return "accepted";
  }

  std::filesystem::path folder_;
};

TEST_F(SceneFileTest, ReadsEveryPart) {
  const std::string path = write("full.yaml", R"(
gdtslam_scene: 1
name: full
description: everything once
wall_defaults: {thickness: 20 cm, base: 10 cm, height: 3 m}
floor: 0
ceiling: 3.1 m
walls:
  - points: [[0, 0], [4, 0], [4, 300 cm]]
    closed: false
    doors: [{leg: 1, from: 0.5, width: 80 cm, height: 2 m, leaf: {angle: 30 deg, hinge: far, thickness: 5 cm}}]
  - {points: [[9, 0], [9, 5]], thickness: 0.1, base: 0, height: 1}
boxes:
  - {centre: [1, 1], size: [0.5, 0.25], height: 1, base: 20 mm, yaw: 45 deg}
  - {centre: [2, 2], size: [0.1, 0.1], height: 1, repeat: {count: 3, step: [0.5, 0]}}
cylinders:
  - {centre: [3, 3], radius: 10 cm, height: 1 m, base: 0.5, sides: 9}
objects:
  - name: pair
    boxes: [{centre: [1, 0], size: [0.2, 0.1], height: 1}]
    cylinders: [{centre: [0, 1], radius: 0.1, height: 1}]
place:
  - {object: pair, at: [10, 20], yaw: 90 deg, repeat: {count: 2, step: [0, 5]}}
meshes:
  - {file: t.stl, unit: cm, scale: 2, position: [1, 2, 3], yaw: 0 deg, up: z}
robot:
  body: {radius: 0.3, height: 50 cm}
  laser:
    preset: hokuyo-961
    first_bearing: -90 deg
    bearing_step: 0.5 deg
    beams: 361
    min_range: 10 cm
    max_range: 30 m
    no_return: 40
    noise: 5 mm
    noise_share: 1 %
    range_resolution: 2 mm
    drop_outs: 0.01
    mirror_rate: 50 Hz
    height: 40 cm
    mount: {x: 0.1, y: -5 cm, yaw: 90 deg}
  wheels:
    track_width: 0.5
    centre_ahead_of_axle: 0.1
    track_width_scale: 1.01
    left_scale: 1.02
    right_scale: 0.99
    slip: 1 cm
    ticks_per_metre: 4000
  motion:
    speed: 0.9 m/s
    acceleration: 0.4 m/s^2
    turn_rate: 45 deg/s
    turn_acceleration: 90 deg/s^2
    corner_cut: 0.7
    spin_above: 100 deg
recording: {scan_rate: 12.5 Hz, odometry_rate: 25}
waypoints:
  - [0, 1]
  - {at: [5, 1], speed: 0.5 m/s, corner_cut: 20 cm, pause: 500 ms, reverse: true}
)");
  write("t.stl", "solid\nvertex 0 0 0\nvertex 100 0 0\nvertex 0 100 0\nendfacet\n");
  const SceneFile file = read_scene(path);
  EXPECT_EQ(file.name, "full");
  ASSERT_EQ(file.scene.walls.size(), 2U);
  const sim::Wall& wall = file.scene.walls[0];
  EXPECT_EQ(wall.points_m[2], Point2(4.0, 3.0));
  EXPECT_EQ(wall.thickness_m, 0.2);
  EXPECT_EQ(wall.base_m, 0.1);
  ASSERT_EQ(wall.doors.size(), 1U);
  EXPECT_EQ(wall.doors[0].leg, 1U);
  EXPECT_EQ(wall.doors[0].width_m, 0.8);
  ASSERT_TRUE(wall.doors[0].leaf);
  EXPECT_NEAR(wall.doors[0].leaf->angle_rad, rad_from_deg(30.0), 1e-15);
  EXPECT_TRUE(wall.doors[0].leaf->hinge_at_far);
  EXPECT_EQ(file.scene.walls[1].height_m, 1.0);
  ASSERT_EQ(file.scene.boxes.size(), 1U + 3U + 2U);
  EXPECT_NEAR(file.scene.boxes[0].yaw_rad, rad_from_deg(45.0), 1e-15);
  EXPECT_EQ(file.scene.boxes[3].centre_m, Point2(3.0, 2.0));
  // The object's box, 1 m ahead in its frame, which is turned to the left.
  EXPECT_NEAR((file.scene.boxes[4].centre_m - Point2(10.0, 21.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((file.scene.boxes[5].centre_m - Point2(10.0, 26.0)).norm(), 0.0, 1e-12);
  ASSERT_EQ(file.scene.cylinders.size(), 3U);
  EXPECT_EQ(file.scene.cylinders[0].sides, 9);
  EXPECT_NEAR((file.scene.cylinders[1].centre_m - Point2(9.0, 20.0)).norm(), 0.0, 1e-12);
  ASSERT_EQ(file.scene.meshes.size(), 1U);
  EXPECT_NEAR((file.scene.meshes[0].vertices[1] - sim::Vec3(3.0, 2.0, 3.0)).norm(), 0.0, 1e-6);
  EXPECT_EQ(file.scene.ceiling_m, 3.1);
  EXPECT_EQ(file.body.radius_m, 0.3);
  const sim::LaserModel& laser = file.config.laser;
  EXPECT_EQ(laser.beam_count, 361U);
  EXPECT_EQ(laser.noise_share, 0.01);
  EXPECT_EQ(laser.mirror_rate_hz, 50.0);
  EXPECT_EQ(laser.no_return_m, 40.0);
  EXPECT_NEAR(file.config.T_base_laser.theta_rad, 0.5 * kPi, 1e-15);
  EXPECT_EQ(file.config.laser_height_m, 0.4);
  EXPECT_EQ(file.config.wheels.ticks_per_m, 4000.0);
  EXPECT_EQ(file.config.wheels.drive.centre_ahead_of_axle_m, 0.1);
  EXPECT_NEAR(file.limits.turn_acceleration_rad_per_s2, 0.5 * kPi, 1e-15);
  EXPECT_EQ(file.config.scan_rate_hz, 12.5);
  EXPECT_EQ(file.config.odometry_rate_hz, 25.0);
  ASSERT_EQ(file.waypoints.size(), 2U);
  EXPECT_EQ(file.waypoints[1].pause_s, 0.5);
  EXPECT_TRUE(file.waypoints[1].is_reverse);
}

TEST_F(SceneFileTest, RefusesWrongKindsAndValues) {
  EXPECT_EQ(refusal("walls:\n- points: [[0, 0], [1, 0]]\n  thicknes: 1\n"),
            "4: walls[0]: unknown key 'thicknes'; did you mean 'thickness'?");
  EXPECT_THAT(refusal("objects: [{name: desk}]\nplace: [{object: dsek, at: [0, 0]}]\n"),
              HasSubstr("did you mean 'desk'?"));
  EXPECT_THAT(refusal("objects: [{name: a}, {name: a}]\n"), HasSubstr("there are two objects 'a'"));
  EXPECT_THAT(refusal("ramps: [{from: [0, 0], to: [1, 0, 0], width: 1}]\n"),
              HasSubstr("2: ramps[0].from: a place [x, y, z] is expected here"));
  EXPECT_THAT(refusal("plates: [{centre: [0, 0], size: [1, 1], heigth: 1}]\n"), HasSubstr("did you mean 'height'?"));
  EXPECT_THAT(refusal("floor: 0\nsills: [{from: [0, 0], to: [0, 0]}]\n"),
              HasSubstr("3: sills[0]: each side must be 1 mm to 2000 m"));
  std::string sills = "floor: 0\nsills:\n";
  for (int i = 0; i < 1001; ++i) sills += "  - {from: [0, 0], to: [1, 0]}\n";
  EXPECT_THAT(refusal(sills), HasSubstr("1004: sills[1000]: the scene has more than 1000 ramps, plates and sills"));
  EXPECT_THAT(refusal("robot: {chassis: {sway_tilt: 0.4}}\n"), HasSubstr("an angle needs its unit"));
  EXPECT_THAT(refusal("robot: {chassis: {wheelbase: 0}}\n"),
              HasSubstr("2: robot.chassis: wheelbase must be 1 cm to 100 m"));
  EXPECT_THAT(refusal("boxes: 3\n"), HasSubstr("2: boxes: a list is expected"));
  EXPECT_THAT(refusal("boxes: [3]\n"), HasSubstr("keys with values are expected"));
  EXPECT_THAT(refusal("floor: low\n"), HasSubstr("2: floor: 'low' is no value"));
  EXPECT_THAT(refusal("floor: .nan\n"), HasSubstr("2: floor"));
  EXPECT_EQ(refusal("floor:\n"), "2: the key 'floor' has no value");
  EXPECT_THAT(refusal("walls: [{points: [[0, 0], [1]]}]\n"), HasSubstr("a point [x, y] is expected"));
  EXPECT_THAT(refusal("robot: {laser: {beams: 1.5}}\n"), HasSubstr("is not a whole number"));
  EXPECT_THAT(refusal("robot: {laser: {height: 1}, laser: {height: 2}}\n"), HasSubstr("the key 'laser' stands twice"));
  EXPECT_THAT(refusal("waypoints: [{at: [0, 0], reverse: yes}]\n"), HasSubstr("neither true nor false"));
}

TEST_F(SceneFileTest, ReadsRowsOfWindows) {
  const std::string path = write("w.yaml", R"(gdtslam_scene: 1
walls:
  - points: [[0, 0], [9, 0], [9, 9]]
    doors: [{from: 0.5}]
    windows:
      - {leg: 1, from: 1, width: 80 cm, sill: 50 cm, head: 2 m}
      - {from: 2, repeat: {count: 3, step: 1.5 m}}
)");
  const std::vector<sim::Door> openings = read_scene(path).scene.walls.at(0).doors;
  ASSERT_EQ(openings.size(), 5U);
  EXPECT_EQ(openings[0].sill_m, 0.0);
  EXPECT_EQ(openings[1].leg, 1U);
  EXPECT_EQ(openings[1].sill_m, 0.5);
  EXPECT_EQ(openings[1].height_m, 2.0);
  EXPECT_EQ(openings[4].from_m, 5.0);
  EXPECT_EQ(openings[4].width_m, 1.2);
  EXPECT_EQ(openings[4].sill_m, 0.9);
  EXPECT_THAT(refusal("walls: [{points: [[0, 0], [9, 0]], windows: [{from: 1, sill: 0}]}]\n"),
              HasSubstr("2: walls[0].windows[0]: sill must be above 0"));
  EXPECT_THAT(refusal("walls: [{points: [[0, 0], [9, 0]], windows: [{from: 1, repeat: {count: 9, step: 1}}]}]\n"),
              HasSubstr("overlaps the opening before it"));
  EXPECT_THAT(refusal("walls: [{points: [[0, 0], [9, 0]], windows: [{from: 1, sil: 1}]}]\n"),
              HasSubstr("did you mean 'sill'?"));
}

TEST_F(SceneFileTest, SizesAreBounded) {
  EXPECT_THAT(refusal("boxes: [{centre: [0, 0], size: [1, 1], height: 1, repeat: {count: 999999, step: [0, 0]}}]\n"),
              HasSubstr("must be 1 to 200000"));
  const std::string many = "{centre: [0, 0], size: [1, 1], height: 1, repeat: {count: 150000, step: [0, 0]}}";
  EXPECT_THAT(refusal("boxes: [" + many + ", " + many + "]\n"), HasSubstr("more than 200000 parts"));
  const std::string row = "{from: 0, width: 1 mm, repeat: {count: 60000, step: 0.002}}";
  EXPECT_THAT(
      refusal("walls: [{points: [[0, 0], [900, 0]], windows: [" + row + ", " + row + ", " + row + ", " + row + "]}]\n"),
      HasSubstr("more than 200000 parts"));
  std::string deep(100'000, '[');
  EXPECT_THAT(refusal("walls: " + deep + "\n"), HasSubstr("not valid YAML"));
  EXPECT_THROW(read_scene(write("big.yaml", std::string((16U << 20U) + 1, '#'))), ConfigError);
}

TEST_F(SceneFileTest, RefusesWhatIsNoScene) {
  EXPECT_THROW(read_scene((folder_ / "absent.yaml").string()), FileError);
  EXPECT_THROW(read_scene(folder_.string()), FileError);
  EXPECT_THROW(read_scene(write("empty.yaml", "")), ConfigError);
  EXPECT_THROW(read_scene(write("two.yaml", "gdtslam_scene: 1\n---\ngdtslam_scene: 1\n")), ConfigError);
  EXPECT_THROW(read_scene(write("none.yaml", "walls: []\n")), ConfigError);
  EXPECT_THROW(read_scene(write("late.yaml", "gdtslam_scene: 2\n")), ConfigError);
  EXPECT_THAT(refusal("walls: [\n"), HasSubstr("not valid YAML"));
  EXPECT_THROW(read_scene(write("mesh.yaml", "gdtslam_scene: 1\nmeshes: [{file: gone.ply}]\n")), FileError);
}

TEST_F(SceneFileTest, ReadsATrajectory) {
  const auto waypoints = read_waypoints(write("t.yaml", "gdtslam_trajectory: 1\nwaypoints: [[0, 0], {at: [1, 2]}]\n"));
  ASSERT_EQ(waypoints.size(), 2U);
  EXPECT_EQ(waypoints[1].position_m, Point2(1.0, 2.0));
  EXPECT_THROW(read_waypoints(write("u.yaml", "gdtslam_trajectory: 1\n")), ConfigError);
  EXPECT_THROW(read_waypoints(write("v.yaml", "gdtslam_trajectory: 1\nwaypoints: []\nspeed: 1\n")), ConfigError);
}

TEST_F(SceneFileTest, FindsAScenePathFirstThenByName) {
  const std::string path = write("hall.yaml", "gdtslam_scene: 1\n");
  EXPECT_EQ(find_scene(path, {}), path);
  EXPECT_EQ(find_scene("hall", {"/nonexistent", folder_.string()}), path);
  EXPECT_EQ(find_scene("hall.yaml", {folder_.string()}), path);
  EXPECT_THROW((void)find_scene(folder_.string(), {folder_.string()}), FileError) << "a folder is no scene";
  try {
    find_scene("hell", {folder_.string()});
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr(folder_.string()));
    EXPECT_THAT(error.what(), HasSubstr("did you mean 'hall'?"));
  }
}

}  // namespace
}  // namespace gdtslam

#endif
