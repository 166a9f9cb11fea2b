// A run against the drive that it was made from: poses, counts, files, and what can be done with it afterwards.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/runs/edits/source_run.hpp"
#include "engine/runs/folder/run_graph.hpp"
#include "engine/runs/sites/run_session.hpp"
#include "engine/runs/views/run_views.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "ring_run.hpp"
#include "unit/back_end/loop_drive.hpp"

namespace gdtslam {
namespace {

using nlohmann::ordered_json;
using test::ring_run;
using testing::HasSubstr;

double farthest_m(const Trajectory& path, const std::vector<Pose2>& truth) {
  double most_m = 0.0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    most_m = std::max(most_m, (path[k].T_map_base.translation() - truth[k].translation()).norm());
  }
  return most_m;
}

TEST(WholeRun, ItsPathIsThatOfTheDrive) {
  const test::RingRun& run = ring_run();
  const Trajectory& path = run.result.outcome.trajectory;
  ASSERT_EQ(path.size(), run.truth.size());
  EXPECT_LT(farthest_m(path, run.truth), 0.1);
  for (std::size_t k = 0; k < path.size(); ++k) {
    ASSERT_NEAR(path[k].stamp_s, 1000.0 + 0.5 * static_cast<double>(k), 1e-6);
    ASSERT_LT(std::fabs(wrap_angle(path[k].T_map_base.theta_rad - run.truth[k].theta_rad)), 0.01) << k;
  }
  EXPECT_FALSE(run.result.outcome.interrupted);
  EXPECT_TRUE(run.result.linkage.empty());
}

TEST(WholeRun, ItsReportSaysWhatTheOutcomeHas) {
  const test::RingRun& run = ring_run();
  const MapOutcome& outcome = run.result.outcome;
  EXPECT_EQ(run.result.report, test::text_of_file(run.folder + "/report.json"));
  const ordered_json report = ordered_json::parse(run.result.report);
  const std::size_t scans = run.truth.size();
  EXPECT_EQ(report.at("format"), 1);
  EXPECT_EQ(report.at("scans"), scans);
  EXPECT_EQ(report.at("log"), ordered_json({run.log}));
  EXPECT_EQ(report.at("interrupted"), false);
  EXPECT_NEAR(report.at("log_duration_s").get<double>(), 0.5 * static_cast<double>(scans - 1), 1e-6);
  EXPECT_NEAR(report.at("path_m").get<double>(), test::kRingRound_m + 10.0, 1.0);
  EXPECT_EQ(report.at("doubtful"), outcome.doubtful.size());
  EXPECT_EQ(report.at("doubtful_scans").size(), outcome.doubtful.size());
  const ordered_json& matches = report.at("matches");
  EXPECT_EQ(matches.at("accepted").get<std::size_t>() + outcome.doubtful.size(), scans);
  EXPECT_EQ(matches.at("weak").get<std::size_t>() + matches.at("refused").get<std::size_t>(), outcome.doubtful.size());
  EXPECT_EQ(report.at("matched").get<std::size_t>() + matches.at("refused").get<std::size_t>(), scans);
  EXPECT_EQ(report.at("keyframe_scans").size(), report.at("keyframes"));
  EXPECT_EQ(report.at("cloud_points"), 0);
  EXPECT_FALSE(report.contains("nodding"));
  EXPECT_FALSE(report.contains("drives"));
  EXPECT_FALSE(report.contains("tiles"));
  EXPECT_FALSE(report.contains("odometry_delay")) << "its stamps are right";
  EXPECT_EQ(report.at("map").at("resolution_m"), 0.025);
  EXPECT_EQ(report.at("gdt").at("resolution_m"), 0.025);
  EXPECT_GT(report.at("match_median_m").get<double>(), 0.0);
  EXPECT_LT(report.at("match_median_m").get<double>(), report.at("match_p99_m").get<double>());
  EXPECT_LT(report.at("match_p99_m").get<double>(), 0.1) << "of walls that are exact, some cells";
}

TEST(WholeRun, ItsTimesAddUp) {
  const ordered_json report = ordered_json::parse(ring_run().result.report);
  const MapOutcome& outcome = ring_run().result.outcome;
  const auto scans = static_cast<double>(ring_run().truth.size());
  double sum_s = 0.0;
  for (const auto& [name, cpu_s] : report.at("stages").items()) {
    EXPECT_GE(cpu_s.get<double>(), 0.0) << name;
    sum_s += cpu_s.get<double>();
  }
  EXPECT_NEAR(sum_s, outcome.cpu_s, 0.1 * outcome.cpu_s + 0.05);
  EXPECT_NEAR(report.at("scans_per_s").get<double>(), scans / outcome.wall_s, 1e-6 * scans / outcome.wall_s);
  EXPECT_NEAR(report.at("scans_per_core_s").get<double>(), scans / outcome.mapper_cpu_s,
              1e-6 * scans / outcome.mapper_cpu_s);
  EXPECT_NEAR(report.at("realtime_factor").get<double>(), outcome.log_duration_s / outcome.wall_s,
              1e-6 * outcome.log_duration_s / outcome.wall_s);
  for (const char* stage :
       {"read", "predict", "match", "local_field", "merge", "mapper_other", "loops", "occupancy", "prepare",
        "write_field", "hash", "write_path", "write_pictures", "write_keyframes", "write_map", "other"}) {
    EXPECT_TRUE(report.at("stages").contains(stage)) << stage;
  }
  EXPECT_FALSE(report.at("stages").contains("cloud"));
}

TEST(WholeRun, ItsMapHasTheWallsAndTheWay) {
  const test::RingRun& run = ring_run();
  const OccupancyMap map = RunReader(run.folder).map();
  for (const Pose2& pose : run.truth) {
    const CellIndex cell = map.geometry.cell_at(pose.translation());
    ASSERT_TRUE(map.geometry.contains(cell));
    EXPECT_EQ(map.at(cell), CellState::kFree);
  }
  // Points of the block's walls 10 cm apart, each with an occupied cell within 10 cm of it.
  const Pose2 T_map_world = inverse(test::ring_drive().front());
  std::size_t points = 0;
  std::size_t found = 0;
  const std::vector<test::Segment> walls = test::rooms_around_a_block();
  for (std::size_t k = 4; k < 8; ++k) {
    const Point2 along = walls[k].to - walls[k].from;
    for (double at_m = 1.0; at_m < along.norm() - 1.0; at_m += 0.1, ++points) {
      const Point2 point = T_map_world * Point2(walls[k].from + at_m / along.norm() * along);
      bool is_there = false;
      for (double dx = -0.1; dx < 0.11; dx += 0.025) {
        for (double dy = -0.1; dy < 0.11; dy += 0.025) {
          const CellIndex cell = map.geometry.cell_at(point + Point2(dx, dy));
          is_there = is_there || (map.geometry.contains(cell) && map.at(cell) == CellState::kOccupied);
        }
      }
      found += is_there ? 1U : 0U;
    }
  }
  EXPECT_GT(points, 700U);
  EXPECT_GT(static_cast<double>(found), 0.9 * static_cast<double>(points));
}

TEST(WholeRun, ItsGraphHasTheStepsAndLoopsOfTheDrive) {
  const test::RingRun& run = ring_run();
  const RunGraph graph = read_run_graph(RunReader(run.folder));
  ASSERT_GE(graph.scans.size(), 10U);
  ASSERT_EQ(graph.graph.poses.size(), graph.scans.size());
  EXPECT_TRUE(std::is_sorted(graph.scans.begin(), graph.scans.end()));
  for (std::size_t place = 0; place < graph.scans.size(); ++place) {
    EXPECT_LT((graph.graph.poses[place].translation() - run.truth[graph.scans[place]].translation()).norm(), 0.15);
  }
  const auto off_m = [&](const PoseRelation& relation) {
    const Pose2 truth = between(run.truth[graph.scans[relation.from]], run.truth[graph.scans[relation.to]]);
    return (relation.T_from_to.translation() - truth.translation()).norm();
  };
  for (const PoseRelation& step : graph.graph.path) {
    EXPECT_EQ(step.to, step.from + 1);
    EXPECT_LT(off_m(step), 0.1);
  }
  const ordered_json closures = ordered_json::parse(run.result.report).at("loops").at("closures");
  ASSERT_EQ(closures.size(), graph.graph.loops.size());
  ASSERT_FALSE(closures.empty()) << "the last 10 m were driven twice";
  for (std::size_t k = 0; k < closures.size(); ++k) {
    const Loop& loop = graph.graph.loops[k];
    EXPECT_EQ(graph.scans[loop.relation.from], closures[k].at("from"));
    EXPECT_EQ(graph.scans[loop.relation.to], closures[k].at("to"));
    EXPECT_EQ(graph.is_on[k], closures[k].at("on"));
    if (!graph.is_on[k]) continue;
    EXPECT_LT(off_m(loop.relation), 0.2) << k;
  }
}

TEST(WholeRun, AsASessionItHasItsPathAndItsPlaces) {
  const test::RingRun& run = ring_run();
  const RunSession session = read_run_session(run.folder);
  EXPECT_EQ(session.name, "ring");
  EXPECT_EQ(session.session.poses.size(), session.kept.keyframes.size());
  EXPECT_EQ(session.session.scans.size(), session.kept.keyframes.size());
  EXPECT_EQ(session.session.places.front(), 0U);
  double path_m = 0.0;
  for (std::size_t k = 0; k < session.session.poses.size(); ++k) {
    if (k > 0) {
      path_m += (session.session.poses[k].translation() - session.session.poses[k - 1].translation()).norm();
    }
    ASSERT_NEAR(session.session.path_m[k], path_m, 1e-3 * path_m + 1e-9) << k;
  }
  EXPECT_EQ(session.session.path.size(), 2 * (session.session.places.size() - 1)) << "by the front end, by the wheels";
  EXPECT_FALSE(session.session.loops.empty());
}

TEST(WholeRun, IsReadAsItIsEdited) {
  const test::RingRun& run = ring_run();
  SourceRun source = read_source_run(run.folder);
  EXPECT_TRUE(source.sessions.empty());
  EXPECT_FALSE(source.earlier);
  EXPECT_EQ(source.outcome.statistics.scans, run.truth.size());
  EXPECT_EQ(source.outcome.keyframes.size(), source.kept.keyframes.size());
  EXPECT_TRUE(source.outcome.closed);
  const std::size_t keyframe = source.kept.keyframes[7].scan;
  EXPECT_EQ(source.outcome.trajectory[keyframe].T_map_base, source.kept.keyframes[7].T_map_base);
  // A quarter turn and a shift by hand: (x, y) becomes (2 - y, 3 + x), and what was along x is along y.
  const Pose2 was = source.outcome.trajectory[5].T_map_base;
  const PoseCovariance c = source.outcome.closed->covariances[5];
  const GraphPlace place = source.graph.places[2];
  move_to_frame({2.0, 3.0, 0.5 * kPi}, source);
  const Pose2 is = source.outcome.trajectory[5].T_map_base;
  EXPECT_NEAR(is.x_m, 2.0 - was.y_m, 1e-9);
  EXPECT_NEAR(is.y_m, 3.0 + was.x_m, 1e-9);
  EXPECT_NEAR(wrap_angle(is.theta_rad - was.theta_rad), 0.5 * kPi, 1e-12);
  const PoseCovariance d = source.outcome.closed->covariances[5];
  EXPECT_NEAR(d.xx, c.yy, 1e-9 * c.yy);
  EXPECT_NEAR(d.yy, c.xx, 1e-9 * c.xx);
  EXPECT_NEAR(d.xy, -c.xy, 1e-6 * std::sqrt(c.xx * c.yy));
  EXPECT_NEAR(d.xt, -c.yt, 1e-6 * std::sqrt(c.yy * c.tt));
  EXPECT_NEAR(d.yt, c.xt, 1e-6 * std::sqrt(c.xx * c.tt));
  EXPECT_EQ(d.tt, c.tt);
  EXPECT_NEAR(source.graph.places[2].T_map_base.x_m, 2.0 - place.T_map_base.y_m, 1e-9);
  EXPECT_EQ(source.kept.keyframes[7].T_map_base, source.outcome.trajectory[keyframe].T_map_base);
}

TEST(WholeRun, IsDrawnAsAsked) {
  const RunReader reader(ring_run().folder);
  for (const char* view : {"map", "graph", "field", "distance"}) {
    const std::string svg =
        picture_bytes(run_view(reader, {.view = view, .size = {{640, 480}}, .title = "the title"}), "svg");
    EXPECT_THAT(svg, HasSubstr("the title")) << view;
    EXPECT_THAT(svg, HasSubstr("640")) << view;
  }
  EXPECT_THAT(picture_bytes(run_view(reader, {}), "svg"), HasSubstr("ring"));
  EXPECT_NO_THROW(run_view(reader, {.size = {{16384, 64}}}));
  EXPECT_THROW(run_view(reader, {.size = {{16385, 64}}}), UsageError);
  EXPECT_THROW(run_view(reader, {.size = {{640, 0}}}), UsageError);
  EXPECT_THROW(run_view(reader, {.view = "maps"}), UsageError);
  EXPECT_THROW(picture_bytes(run_view(reader, {}), "gif"), UsageError);
}

}  // namespace
}  // namespace gdtslam
