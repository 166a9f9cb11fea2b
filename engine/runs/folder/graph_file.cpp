#include "graph_file.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <iterator>

namespace gdtslam {
namespace {

void append_edge(std::string& text, std::size_t from, std::size_t to, const Pose2& T, const PoseInformation& i,
                 double weight) {
  fmt::format_to(std::back_inserter(text), "EDGE_SE2 {} {} {} {} {} {} {} {} {} {} {}\n", from, to, T.x_m, T.y_m,
                 T.theta_rad, weight * i.xx, weight * i.xy, weight * i.xt, weight * i.yy, weight * i.yt, weight * i.tt);
}

}  // namespace

std::string graph_text(const ClosedPath& closed) {
  std::string text;
  for (const GraphPlace& place : closed.places) {
    const Pose2& T = place.T_map_base;
    fmt::format_to(std::back_inserter(text), "VERTEX_SE2 {} {} {} {}\n", place.scan, T.x_m, T.y_m, T.theta_rad);
  }
  for (const PathRelation& step : closed.path) {
    append_edge(text, step.from, step.to, step.T_from_to, step.information, 1.0);
  }
  for (const ClosedLoop& loop : closed.loops) {
    append_edge(text, loop.from, loop.to, loop.T_from_to, loop.information, loop.weight);
  }
  return text;
}

}  // namespace gdtslam
