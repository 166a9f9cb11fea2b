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
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/folder/run_views.hpp"
#include "engine/runs/sites/run_session.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "ring_run.hpp"
#include "unit/back_end/loop_drive.hpp"

namespace gdtslam {
namespace {

using nlohmann::ordered_json;
using test::ring_run;
using testing::HasSubstr;

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
