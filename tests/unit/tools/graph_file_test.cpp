// graph.g2o: read back word for word, information as weights make it.
#include "engine/runs/folder/graph_file.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

namespace gdtslam {
namespace {

struct G2oLine {
  std::string tag;
  std::vector<double> numbers;
};

std::vector<G2oLine> g2o_lines(const std::string& text) {
  std::vector<G2oLine> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    lines.emplace_back();
    words >> lines.back().tag;
    for (std::string word; words >> word;) lines.back().numbers.push_back(std::stod(word));
  }
  return lines;
}

TEST(GraphFile, HasPlacesPathAndLoopsInThatOrder) {
  const PoseInformation information{.xx = 1.0 / 3.0, .xy = -2.0, .xt = 3.0, .yy = 40.0, .yt = -5.0e-7, .tt = 6.0e12};
  ClosedPath closed;
  closed.places = {{0, {}}, {40, {1.0 / 7.0, -2.5, 3.0}}};
  closed.path = {{.from = 0, .to = 40, .T_from_to = {0.1, -0.2, 0.3}, .information = information}};
  closed.loops.push_back(
      {.from = 0, .to = 40, .T_from_to = {-1.0e-9, 2.0, -3.0}, .information = information, .weight = 0.125});
  const std::vector<G2oLine> lines = g2o_lines(graph_text(closed));
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0].tag, "VERTEX_SE2");
  EXPECT_EQ(lines[1].numbers, (std::vector<double>{40.0, 1.0 / 7.0, -2.5, 3.0}));
  EXPECT_EQ(lines[2].tag, "EDGE_SE2");
  EXPECT_EQ(lines[2].numbers,
            (std::vector<double>{0.0, 40.0, 0.1, -0.2, 0.3, 1.0 / 3.0, -2.0, 3.0, 40.0, -5.0e-7, 6.0e12}));
  EXPECT_EQ(lines[3].tag, "EDGE_SE2");
  EXPECT_EQ(lines[3].numbers,
            (std::vector<double>{0.0, 40.0, -1.0e-9, 2.0, -3.0, 0.125 / 3.0, -0.25, 0.375, 5.0, -6.25e-8, 7.5e11}));
}

TEST(GraphFile, IsEmptyWithoutPlaces) { EXPECT_EQ(graph_text({}), ""); }

}  // namespace
}  // namespace gdtslam
