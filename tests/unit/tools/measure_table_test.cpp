// What `measure` prints: metres throughout, no sign before a zero, the same values as text, JSON and CSV.
#include "engine/runs/evaluation/measure_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

/// A box seen from two sides, and one of which only a face was seen.
Measurement two_boxes() {
  const double none = std::numeric_limits<double>::infinity();
  const MeasuredBox whole{.centre = {1.0, -2.0, 0.25},
                          .yaw_rad = rad_from_deg(30.0),
                          .width = {.value_m = 0.5829, .sigma_m = 0.0002, .is_observed = true},
                          .depth = {.value_m = 0.4, .sigma_m = 0.01, .is_observed = false},
                          .height = {.value_m = 0.5, .sigma_m = 0.001, .is_observed = true},
                          .points = 120,
                          .face_rms_m = 0.0042,
                          .face_normal = {0.0, -1.0, -0.0}};
  MeasuredBox face = whole;
  face.depth = {.value_m = 0.0, .sigma_m = none, .is_observed = false};
  return {.cloud = "c.ply", .points = 500, .viewpoint = {}, .has_boxes = true, .boxes = {whole, face}, .planes = {}};
}

TEST(MeasureTable, BoxesAsJsonAndCsv) {
  Measurement measured = two_boxes();
  const nlohmann::ordered_json json = as_json(measured);
  EXPECT_TRUE(json.at("viewpoint_m").is_null());
  EXPECT_EQ(json.at("viewpoint_source"), "none");
  EXPECT_FALSE(json.contains("planes"));
  const nlohmann::ordered_json& boxes = json.at("boxes");
  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_EQ(boxes[0].at("width").dump(), R"({"value_m":0.5829,"sigma_m":0.0002,"both_ends_seen":true})");
  EXPECT_EQ(boxes[1].at("depth").dump(), R"({"value_m":null,"sigma_m":null,"both_ends_seen":false})");
  EXPECT_NEAR(boxes[0].at("yaw_deg").get<double>(), 30.0, 1e-9);
  EXPECT_EQ(boxes[0].at("face_normal").dump(), "[0.0,-1.0,0.0]");
  const std::string csv = as_csv(measured);
  EXPECT_THAT(csv, HasSubstr("\n1,0.5829,0.0002,1,0.4,0.01,0,0.5,0.001,1,1,-2,0.25,"));
  EXPECT_THAT(csv, HasSubstr("\n2,0.5829,0.0002,1,,,0,0.5,0.001,1,1,-2,0.25,"));
  EXPECT_THAT(csv, HasSubstr(",120,0.0042\n"));
  measured.viewpoint = Point3(0.5, -0.0, 1.0);
  measured.viewpoint_source = ViewpointSource::kGiven;
  EXPECT_EQ(as_json(measured).at("viewpoint_m").dump(), "[0.5,0.0,1.0]");
  EXPECT_EQ(as_json(measured).at("viewpoint_source"), "given");
}

TEST(MeasureTable, MeasuresWhatWasAskedFor) {
  const std::vector<CloudPoint> nothing;
  MeasureJob job{.cloud = "c.ply", .boxes = true};
  job.viewpoint = Point3(1.0, 2.0, 3.0);
  const Measurement boxes = measure_cloud(job, nothing);
  EXPECT_TRUE(boxes.has_boxes && !boxes.has_planes && !boxes.is_projection);
  EXPECT_EQ(boxes.viewpoint_source, ViewpointSource::kGiven);
  EXPECT_EQ(boxes.viewpoint, Point3(1.0, 2.0, 3.0));
  job.origin_m = {500'000.0, 5'400'000.0, 0.0};
  job.viewpoint = Point3(500'001.25, 5'399'998.5, 3.0);
  EXPECT_EQ(measure_cloud(job, nothing).viewpoint, Point3(1.25, -1.5, 3.0)) << "in the frame of the points";
  job = {.cloud = "c.ply", .planes = true};
  const Measurement planes = measure_cloud(job, nothing);
  EXPECT_TRUE(planes.has_planes && !planes.has_boxes);
  EXPECT_EQ(planes.viewpoint_source, ViewpointSource::kNone);
}

}  // namespace
}  // namespace gdtslam
