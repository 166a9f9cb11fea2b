// graph.g2o: read back word for word, information as weights make it.
#include "engine/runs/folder/loop_files.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// A file of this text that no other process writes, for as long as the object lives.
class GraphFileText {
 public:
  explicit GraphFileText(const std::string& text)
      : path_(testing::TempDir() + "graph_file_test." + std::to_string(::getpid()) + ".g2o") {
    std::ofstream(path_) << text;
  }
  GraphFileText(const GraphFileText&) = delete;
  GraphFileText& operator=(const GraphFileText&) = delete;
  ~GraphFileText() { std::remove(path_.c_str()); }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

TEST(GraphFile, ReadsBackWhatItWroteBitForBit) {
  const PoseInformation information{.xx = 1.0 / 3.0, .xy = -2.0, .xt = 3.0, .yy = 40.0, .yt = -5.0e-7, .tt = 6.0e12};
  ClosedPath closed;
  closed.places = {{0, {}}, {40, {1.0 / 7.0, -2.5, 3.0}}};
  closed.path = {{.from = 0, .to = 40, .T_from_to = {0.1, -0.2, 0.3}, .information = information}};
  closed.loops = {{.from = 0, .to = 40, .T_from_to = {}, .information = information, .weight = 0.125}};
  const GraphFileText file(graph_text(closed));
  const GraphLines read = read_graph(file.path());
  ASSERT_EQ(read.places.size(), 2U);
  EXPECT_EQ(read.places[1].scan, 40U);
  EXPECT_EQ(read.places[1].T_map_base, closed.places[1].T_map_base);
  ASSERT_EQ(read.relations.size(), 2U);
  EXPECT_EQ(read.relations[0].to, 40U);
  EXPECT_EQ(read.relations[0].T_from_to, closed.path[0].T_from_to);
  EXPECT_EQ(read.relations[0].information.yt, information.yt);
  EXPECT_EQ(read.relations[0].information.tt, information.tt);
  EXPECT_EQ(read.relations[1].information.xy, -0.25);
  EXPECT_EQ(read.relations[1].information.tt, 7.5e11);
}

TEST(GraphFile, RefusesWhatIsNoGraphWithItsLine) {
  for (const char* const line :
       {"VERTEX_SE2 1 0 0", "VERTEX_SE2 -1 0 0 0", "VERTEX_SE2 1 0 0 nan", "VERTEX_SE2 1 0 0 0 0", "VERTEX_SE2",
        "EDGE_SE2 0 1 0 0 0 1 0 0 1 0", "EDGE_SE2 0 1 0 0 0 1 0 0 1 0 inf", "EDGE_SE2 0 1.5 0 0 0 1 0 0 1 0 1",
        "EDGE_SE3 0 1", "# a comment", " VERTEX_SE2 1 0 0 0", "VERTEX_SE2 99999999999999999999 0 0 0"}) {
    const GraphFileText file("VERTEX_SE2 0 0 0 0\n\n" + std::string(line) + "\n");
    try {
      (void)read_graph(file.path());
      ADD_FAILURE() << "taken: " << line;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(":3"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW((void)read_graph("/nowhere/graph.g2o"), FileError);
}

}  // namespace
}  // namespace gdtslam
