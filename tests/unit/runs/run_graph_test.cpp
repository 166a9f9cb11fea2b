// The graph of a run out of its two files: of a robot that stood still, and of files that do not belong together.
#include "engine/runs/folder/run_reader.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "engine/io/sha256.hpp"
#include "gdtslam/core/error.hpp"
#include "ring_run.hpp"

namespace gdtslam {
namespace {

using test::ring_run;
using testing::HasSubstr;

/// The lines of graph.g2o by their kind.
struct GraphText {
  std::vector<std::string> vertices;
  std::vector<std::string> edges;
};

GraphText graph_text_of(const std::string& folder) {
  GraphText text;
  std::istringstream lines(test::text_of_file(folder + "/graph.g2o"));
  for (std::string line; std::getline(lines, line);) {
    (line.starts_with("VERTEX") ? text.vertices : text.edges).push_back(line);
  }
  return text;
}

/// Puts another graph into a run, and into its report that it is the right one.
void replace_graph(const std::string& run, const GraphText& text) {
  std::string graph;
  for (const auto* const lines : {&text.vertices, &text.edges}) {
    for (const std::string& line : *lines) graph += line + '\n';
  }
  std::ofstream(run + "/graph.g2o", std::ios::binary) << graph;
  nlohmann::ordered_json report = nlohmann::ordered_json::parse(test::text_of_file(run + "/report.json"));
  for (nlohmann::ordered_json& row : report.at("files")) {
    if (row.at(0) == "graph.g2o") row = {"graph.g2o", graph.size(), Sha256().update(graph).hex()};
  }
  std::ofstream(run + "/report.json", std::ios::binary) << report.dump(2) << '\n';
}

/// What is said of the run around the ring once its graph was changed so; nothing where it is read.
std::string refusal_of_graph(const std::function<void(GraphText&)>& change) {
  const test::RunsFolder folder("run-graph");
  const std::string copy = folder.path("run");
  std::filesystem::copy(ring_run().folder, copy, std::filesystem::copy_options::recursive);
  GraphText text = graph_text_of(copy);
  change(text);
  replace_graph(copy, text);
  try {
    read_run_graph(RunReader(copy));
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(copy + "/graph.g2o"));
    return error.what();
  }
  return "";
}

std::size_t loops_of_ring() { return read_run_graph(RunReader(ring_run().folder)).graph.loops.size(); }

TEST(RunGraphFiles, OfARobotThatStoodStillAreOnePlaceWithoutSteps) {
  const test::RunsFolder folder("one-place");
  test::write_ring_log(folder.path("still.log"), {test::ring_drive().front()}, 3);
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  map_logs(test::ring_request(folder.path("still.log"), folder.path("run")), *cpu);
  const RunGraph graph = read_run_graph(RunReader(folder.path("run")));
  EXPECT_EQ(graph.scans, std::vector<std::size_t>{0});
  EXPECT_EQ(graph.graph.poses, std::vector<Pose2>{Pose2{}});
  EXPECT_TRUE(graph.graph.path.empty());
  EXPECT_TRUE(graph.graph.loops.empty());
}

TEST(RunGraphFiles, UnchangedAreRead) {
  EXPECT_EQ(refusal_of_graph([](GraphText&) {}), "");
}

TEST(RunGraphFiles, WithOtherEdgesThanTheReportTellsOfAreRefused) {
  const std::size_t loops = loops_of_ring();
  ASSERT_GE(loops, 2U);
  const auto with_last_edges = [](std::size_t count) {
    return refusal_of_graph([count](GraphText& text) {
      text.edges.erase(text.edges.begin(), text.edges.end() - static_cast<std::ptrdiff_t>(count));
    });
  };
  EXPECT_THAT(with_last_edges(loops - 1), HasSubstr("has fewer edges than the report has loops"));
  EXPECT_THAT(with_last_edges(loops), HasSubstr("has no edge from one of its places to the next"));
  EXPECT_THAT(refusal_of_graph([](GraphText& text) { std::swap(text.edges.back(), text.edges.end()[-2]); }),
              HasSubstr("where the report has a loop from"));
  EXPECT_THAT(refusal_of_graph([](GraphText& text) { text.edges.pop_back(); }),
              HasSubstr("where the report has a loop from"));
}

}  // namespace
}  // namespace gdtslam
