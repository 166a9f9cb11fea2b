// find_boxes before a scanner whose beams are cast one by one at boxes of known size.
#include "gdtslam/cloud/plane.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/cloud_scenes.hpp"

namespace gdtslam {
namespace {

using test::Rectangle;
using test::StandingScanner;

// A room around the origin, 2.5 m high.
std::vector<Rectangle> room_around() {
  std::vector<Rectangle> sides = test::room({6.0, 5.0, 2.5});
  for (Rectangle& side : sides) side.corner -= Point3(2.5, 2.5, 0.0);
  return sides;
}

void add(std::vector<Rectangle>& scene, const std::vector<Rectangle>& more) {
  scene.insert(scene.end(), more.begin(), more.end());
}

BoxSearch search_from(const Point3& viewpoint) {
  BoxSearch search;
  search.viewpoint = viewpoint;
  return search;
}

TEST(FindBoxes, MeasuresABoxThatIsSeenFromTheFrontOnly) {
  // The width is along the first axis of a box: turned by 90 deg it is across the view.
  Random random(1);
  std::vector<Rectangle> scene = room_around();
  add(scene, test::box_sides({1.8, 0.6, 0.0}, 1.5707963 + 0.32, {0.5829, 0.42, 0.8}));
  const StandingScanner scanner;
  const std::vector<MeasuredBox> boxes = find_boxes(scan(scanner, scene, random), search_from(scanner.at));
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_NEAR(boxes[0].width.value_m, 0.5829, 0.001);
  EXPECT_TRUE(boxes[0].width.is_observed);
  EXPECT_NEAR(boxes[0].height.value_m, 0.8, 0.001);
  EXPECT_FALSE(boxes[0].height.is_observed);  // the scanner never looked below itself
  EXPECT_NEAR(boxes[0].face_rms_m, 0.01, 0.001);
  EXPECT_NEAR(boxes[0].yaw_rad, 1.5707963 + 0.32 - 3.1415927, 0.01);
}

TEST(FindBoxes, MeasuresTheDepthWhereASideIsSeen) {
  Random random(2);
  std::vector<Rectangle> scene = room_around();
  add(scene, test::box_sides({1.7, -0.9, 0.0}, 1.5707963, {0.4, 0.3, 0.6}));
  const StandingScanner scanner;
  const std::vector<MeasuredBox> boxes = find_boxes(scan(scanner, scene, random), search_from(scanner.at));
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_NEAR(boxes[0].width.value_m, 0.4, 0.003);
  EXPECT_LT(boxes[0].width.sigma_m, 0.003);
  EXPECT_NEAR(boxes[0].depth.value_m, 0.3, 0.004);
  EXPECT_TRUE(boxes[0].depth.is_observed);
  EXPECT_NEAR(boxes[0].centre.x(), 1.7, 0.004);
  EXPECT_NEAR(boxes[0].centre.y(), -0.9, 0.004);
  EXPECT_NEAR(boxes[0].centre.z(), 0.3, 0.004);
}

TEST(FindBoxes, MeasuresTheDepthOnTheUpperSideAndTheHeightDownToTheFloor) {
  Random random(3);
  std::vector<Rectangle> scene = room_around();
  add(scene, test::box_sides({1.6, 0.0, 0.0}, 1.5707963, {0.5, 0.35, 0.4}));
  StandingScanner scanner;
  scanner.at = {0.0, 0.0, 1.2};
  scanner.first_elevation_rad = -0.9;
  scanner.scans = 330;
  const std::vector<MeasuredBox> boxes = find_boxes(scan(scanner, scene, random), search_from(scanner.at));
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_NEAR(boxes[0].width.value_m, 0.5, 0.003);
  // Along the upper side one scan is 16 mm from the next, at all bearings alike.
  EXPECT_NEAR(boxes[0].depth.value_m, 0.35, 3.0 * boxes[0].depth.sigma_m);
  EXPECT_LT(boxes[0].depth.sigma_m, 0.008);
  EXPECT_TRUE(boxes[0].depth.is_observed);
  EXPECT_NEAR(boxes[0].height.value_m, 0.4, 0.003);
  EXPECT_TRUE(boxes[0].height.is_observed);
}

TEST(FindBoxes, AnEndBehindSomethingElseIsNotSeen) {
  Random random(4);
  std::vector<Rectangle> scene = room_around();
  add(scene, test::box_sides({2.0, 0.0, 0.0}, 1.5707963, {0.6, 0.3, 0.8}));
  scene.push_back({{1.0, 0.1, 0.0}, {0.0, 0.5, 0.0}, {0.0, 0.0, 2.0}});  // a screen before its left end
  const StandingScanner scanner;
  const std::vector<MeasuredBox> boxes = find_boxes(scan(scanner, scene, random), search_from(scanner.at));
  const auto at_back =
      std::find_if(boxes.begin(), boxes.end(), [](const MeasuredBox& box) { return box.centre.x() > 1.5; });
  ASSERT_NE(at_back, boxes.end());
  EXPECT_FALSE(at_back->width.is_observed);
  EXPECT_LT(at_back->width.value_m, 0.55);
}

TEST(FindBoxes, WallsAndAnEmptyRoomAreNoBoxes) {
  Random random(5);
  const StandingScanner scanner;
  std::vector<Rectangle> scene = room_around();
  EXPECT_TRUE(find_boxes(scan(scanner, scene, random), search_from(scanner.at)).empty());
  // A piece of wall from floor to ceiling, 1 m wide, that juts out of the wall behind.
  add(scene, test::box_sides({3.2, 0.0, 0.0}, 1.5707963, {1.0, 1.0, 2.5}));
  EXPECT_TRUE(find_boxes(scan(scanner, scene, random), search_from(scanner.at)).empty());
  EXPECT_TRUE(find_boxes({}, {}).empty());
}

TEST(FindBoxes, ProjectionAndNoViewpointMeasureTheSameBoxLessExactly) {
  Random random(6);
  std::vector<Rectangle> scene = room_around();
  add(scene, test::box_sides({1.8, 0.2, 0.0}, 1.5707963, {0.5, 0.4, 0.8}));
  const StandingScanner scanner;
  const Cloud cloud = scan(scanner, scene, random);
  BoxSearch search = search_from(scanner.at);
  search.is_projection = true;
  const std::vector<MeasuredBox> projected = find_boxes(cloud, search);
  ASSERT_EQ(projected.size(), 1U);
  EXPECT_NEAR(projected[0].width.value_m, 0.5, 0.002);
  EXPECT_EQ(projected[0].face_normal.z(), 0.0);
  search.viewpoint.reset();
  const std::vector<MeasuredBox> alone = find_boxes(cloud, search);
  // The lowest parts of the walls behind the scanner look like boxes, too, when nobody knows from where they were seen.
  const auto in_front =
      std::find_if(alone.begin(), alone.end(), [](const MeasuredBox& box) { return std::fabs(box.centre.y()) < 1.0; });
  ASSERT_NE(in_front, alone.end());
  EXPECT_NEAR(in_front->width.value_m, 0.5, 0.015);
  EXPECT_FALSE(in_front->width.is_observed);
}

TEST(StandingViewpoint, IsFoundFromTheElevations) {
  Random random(7);
  StandingScanner scanner;
  scanner.at = {0.12, 0.0, 0.45};
  const Cloud cloud = scan(scanner, room_around(), random);
  const std::optional<Point3> found = standing_viewpoint(cloud);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((*found - scanner.at).norm(), 0.005);
}

TEST(StandingViewpoint, IsNotFoundWhereThereIsNone) {
  Random random(8);
  StandingScanner scanner;
  Cloud cloud = scan(scanner, room_around(), random);
  scanner.at = {1.5, 1.0, 0.3};  // the scanner went on
  const Cloud later = scan(scanner, room_around(), random);
  Cloud both = cloud;
  both.insert(both.end(), later.begin(), later.end());
  EXPECT_FALSE(standing_viewpoint(both).has_value());
  for (CloudPoint& point : cloud) point.elevation_rad = 0.0F;  // a cloud of another make
  EXPECT_FALSE(standing_viewpoint(cloud).has_value());
  EXPECT_FALSE(standing_viewpoint({}).has_value());
}

}  // namespace
}  // namespace gdtslam
