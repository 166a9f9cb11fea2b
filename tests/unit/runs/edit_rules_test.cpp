// What a user or a file may state of an edit, at and beside each limit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "engine/runs/edits/edit_run.hpp"
#include "engine/runs/edits/edit_steps.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "ring_run.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

template <class Parse>
std::string fault_of(const Parse& parse) {
  try {
    static_cast<void>(parse());
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

std::string fault_of_steps(const std::string& steps) {
  return fault_of([&] {
    return parse_edits(R"({"format": 1, "run": "r", "begins_at_s": 0, "steps": [)" + steps + "]}", "edits.json");
  });
}

TEST(EditRules, NumbersOfAMapReachAMillionAndThoseOfTheWorldABillion) {
  const auto frame = [](const std::string& origin) {
    return fault_of_steps(R"({"step": "frame", "direction_by": "stated", "origin": )" + origin + "}");
  };
  for (const char* origin : {"[1e6, 0, 0]", "[-1e6, 0, 0]", "[0, 1e6, 0]", "[0, 0, -1e6]"}) {
    EXPECT_EQ(frame(origin), "accepted") << origin;
  }
  for (const char* origin : {"[1.001e6, 0, 0]", "[-1.001e6, 0, 0]", "[0, 1.001e6, 0]", "[0, 0, 1.001e6]"}) {
    EXPECT_THAT(frame(origin), HasSubstr("numbers from -1e+06 to 1e+06")) << origin;
  }
  const auto crop = [](const std::string& low, const std::string& high) {
    return fault_of_steps(R"({"step": "crop", "low": )" + low + R"(, "high": )" + high + "}");
  };
  EXPECT_EQ(crop("[-1e6, -1e6]", "[1e6, 1e6]"), "accepted");
  EXPECT_THAT(crop("[0, 0]", "[1, 1.001e6]"), HasSubstr("numbers from"));
  EXPECT_THAT(crop("[0, 0]", "[0, 1]"), HasSubstr("is not above 'low'"));
  EXPECT_THAT(crop("[0, 0]", "[1, 0]"), HasSubstr("is not above 'low'"));
  EXPECT_THAT(crop("[0, 0]", "[-1, 1]"), HasSubstr("is not above 'low'"));
}

TEST(EditRules, AnOriginIsTwoNumbersOrThree) {
  EXPECT_FALSE(parse_origin("1.5,-2").has_angle);
  const StatedOrigin turned = parse_origin(" 1.5 , -2 , 270 ");
  EXPECT_TRUE(turned.has_angle);
  EXPECT_EQ(turned.pose.x_m, 1.5);
  EXPECT_EQ(turned.pose.y_m, -2.0);
  EXPECT_NEAR(turned.pose.theta_rad, -0.5 * kPi, 1e-12);
  EXPECT_EQ(fault_of([] { return parse_origin("1e6,-1e6,1e6"); }), "accepted");
  for (const char* text : {"", "1", "1,2,3,4", "1.001e6,0", "0,-1.001e6", "1,x", "1,,2", "1,2x", "nan,0", "inf,0"}) {
    EXPECT_THAT(fault_of([&] { return parse_origin(text); }), HasSubstr("--origin: ")) << text;
  }
}

TEST(EditRules, ARectangleHasAnArea) {
  const RegionBounds bounds = parse_rectangle("20,-5,-5,12.5");
  EXPECT_EQ(bounds.low_m, Point2(-5.0, -5.0));
  EXPECT_EQ(bounds.high_m, Point2(20.0, 12.5));
  for (const char* text : {"1,1,1,2", "1,1,2,1"}) {
    EXPECT_THAT(fault_of([&] { return parse_rectangle(text); }), HasSubstr("it has no area")) << text;
  }
  EXPECT_EQ(fault_of([] { return parse_rectangle("-1e6,-1e6,1e6,1e6"); }), "accepted");
  for (const char* text : {"1,1,2", "1,1,2,2,3", "0,0,1,1.001e6", "-1.001e6,0,1,1"}) {
    EXPECT_THAT(fault_of([&] { return parse_rectangle(text); }), HasSubstr("two corners in metres")) << text;
  }
}

TEST(EditRules, ARegionHasThreeCorners) {
  EXPECT_EQ(parse_region("1,1 4,1  4,3").corners_m, (std::vector<Point2>{{1, 1}, {4, 1}, {4, 3}}));
  for (const char* text : {"1,1 4,1", "1,1 4,1 4", "1,1 4,1 4,1.001e6", ""}) {
    EXPECT_THAT(fault_of([&] { return parse_region(text); }), HasSubstr("three corners or more")) << text;
  }
  const test::RunsFolder folder("regions");
  std::ofstream(folder.path("three")) << "# a room\n1,1\n\n4 1  # its door\n 4,3\n";
  EXPECT_EQ(parse_region(folder.path("three")).corners_m, (std::vector<Point2>{{1, 1}, {4, 1}, {4, 3}}));
  std::ofstream(folder.path("two")) << "1,1\n4,1\n";
  EXPECT_THAT(fault_of([&] { return parse_region(folder.path("two")); }), HasSubstr("two: has fewer than three"));
  std::ofstream(folder.path("bad")) << "1,1\n4,1,7\n4,3\n";
  EXPECT_THAT(fault_of([&] { return parse_region(folder.path("bad")); }), HasSubstr("bad:2: has \"4,1,7\" where"));
  std::ofstream(folder.path("far")) << "1,1\n4,1\n4,1.001e6\n";
  EXPECT_THAT(fault_of([&] { return parse_region(folder.path("far")); }), HasSubstr("far:3: has"));
  std::string most;
  for (int k = 0; k < 10'000; ++k) most += "1,1\n";
  std::ofstream(folder.path("most")) << most;
  EXPECT_EQ(parse_region(folder.path("most")).corners_m.size(), 10'000U);
  std::ofstream(folder.path("more")) << most << "1,1\n";
  EXPECT_THAT(fault_of([&] { return parse_region(folder.path("more")); }),
              HasSubstr("more:10001: is one more than 10000 places"));
}

TEST(EditRules, PointsOfTheWorldReachABillion) {
  const std::vector<PointPair> pairs = parse_point_pairs("1,2=1e9,-1e9");
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].map_m, Point2(1.0, 2.0));
  EXPECT_EQ(pairs[0].world_m, Point2(1.0e9, -1.0e9));
  for (const char* text : {"1,2", "1,2=3", "1,2=1.001e9,0", "1.001e6,2=0,0", "1,2=0,-1.001e9"}) {
    EXPECT_NE(fault_of([&] { return parse_point_pairs(text); }), "accepted") << text;
  }
}

}  // namespace
}  // namespace gdtslam
