// What `measure --planes` prints: metres throughout, no sign before a zero, the same values as text, JSON and CSV.
#include "engine/runs/measuring/measure_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace gdtslam {
namespace {

using testing::HasSubstr;
using testing::Not;

Measurement two_planes() {
  MeasuredPlane floor{.patch = {}, .kind = PlaneKind::kFloor, .area_m2 = 24.004, .extent_m = {6.0, 4.0}};
  floor.patch.plane = {.normal = {-0.0002, -0.0, 0.99999998}, .offset_m = -0.00004};
  floor.patch.points = {0, 1, 2, 3};
  floor.patch.rms_m = 0.0099;
  floor.patch.sigma_offset_m = 0.0001;
  floor.patch.centre = {3.0, 2.0, -0.0004};
  MeasuredPlane wall{.patch = floor.patch, .kind = PlaneKind::kWall, .area_m2 = 10.0, .extent_m = {4.0, 2.5}};
  wall.patch.plane = {.normal = {-1.0, 0.0, 0.0}, .offset_m = 3.04};
  wall.patch.centre = {-3.04, 1.0, 1.25};
  return {.cloud = "c.ply", .points = 8, .viewpoint = {}, .has_planes = true, .boxes = {}, .planes = {floor, wall}};
}

TEST(MeasureTable, PlanesInMetresWithKindAreaAndExtent) {
  const std::string text = as_text(two_planes());
  EXPECT_THAT(text, HasSubstr("\n1     floor      24.00 m2    6.00 x 4.00 m  "));
  EXPECT_THAT(
      text,
      HasSubstr("\n2     wall       10.00 m2    4.00 x 2.50 m  -1.000  0.000  0.000    3.0400 +- 0.0001 m  0.0099 m"));
  EXPECT_THAT(text, Not(HasSubstr("-0.000")));
  EXPECT_THAT(text, Not(HasSubstr("cm")));
  EXPECT_THAT(text, Not(HasSubstr("mm")));
  EXPECT_THAT(text, HasSubstr("-3.040, 1.000, 1.250 m"));
}

TEST(MeasureTable, JsonAndCsvHaveWhatTheTextHas) {
  const nlohmann::ordered_json planes = as_json(two_planes()).at("planes");
  ASSERT_EQ(planes.size(), 2U);
  EXPECT_EQ(planes[0].at("kind"), "floor");
  EXPECT_EQ(planes[0].at("area_m2"), 24.004);
  EXPECT_EQ(planes[0].at("extent_m"), (nlohmann::ordered_json{6.0, 4.0}));
  EXPECT_THAT(planes[0].at("normal").dump(), Not(HasSubstr("-0.0,")));
  EXPECT_EQ(planes[1].at("offset_m"), 3.04);
  const std::string csv = as_csv(two_planes());
  EXPECT_THAT(csv, HasSubstr("plane,kind,area_m2,extent_m,extent_other_m,normal_x,"));
  EXPECT_THAT(csv, HasSubstr("\n1,floor,24.004,6,4,-0.0002,0,"));
  EXPECT_THAT(csv, HasSubstr("\n2,wall,10,4,2.5,-1,0,0,3.04,"));
}

}  // namespace
}  // namespace gdtslam
