#include "graph_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string_view>

#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/line_reader.hpp"
#include "engine/io/message_text.hpp"
#include "engine/runs/loops/number_list.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

void append_edge(std::string& text, std::size_t from, std::size_t to, const Pose2& T, const PoseInformation& i,
                 double weight) {
  fmt::format_to(std::back_inserter(text), "EDGE_SE2 {} {} {} {} {} {} {} {} {} {} {}\n", from, to, T.x_m, T.y_m,
                 T.theta_rad, weight * i.xx, weight * i.xy, weight * i.xt, weight * i.yy, weight * i.yt, weight * i.tt);
}

constexpr std::size_t kMostGraphLine = 4096;
constexpr std::string_view kVertex = "VERTEX_SE2";
constexpr std::string_view kEdge = "EDGE_SE2";

std::size_t scan_number(double value, const FilePosition& position) {
  constexpr double kMostScanNumber = 1.0e15;  // whole numbers of a double
  if (!(value >= 0.0 && value < kMostScanNumber) || value != std::floor(value)) {
    throw InputError(position, fmt::format("has {} where the number of a scan should be", value));
  }
  return static_cast<std::size_t>(value);
}

void read_graph_line(std::string_view text, const FilePosition& position, GraphLines& graph) {
  const std::string_view word = text.substr(0, text.find_first_of(" \t"));
  if (word != kVertex && word != kEdge) {
    throw InputError(position,
                     fmt::format("begins with {}, which is neither {} nor {}", in_quotes(word), kVertex, kEdge));
  }
  const std::size_t count = word == kVertex ? 4 : 11;
  const std::optional<std::vector<double>> numbers = numbers_in(text.substr(word.size()), "");
  if (!numbers || numbers->size() != count) {
    throw InputError(position, fmt::format("has {} where {} numbers should be", in_quotes(text), count));
  }
  const std::vector<double>& n = *numbers;
  if (word == kVertex) {
    graph.places.push_back({scan_number(n[0], position), {n[1], n[2], n[3]}});
  } else {
    graph.relations.push_back(
        {.from = scan_number(n[0], position),
         .to = scan_number(n[1], position),
         .T_from_to = {n[2], n[3], n[4]},
         .information = {.xx = n[5], .xy = n[6], .xt = n[7], .yy = n[8], .yt = n[9], .tt = n[10]}});
  }
}

}  // namespace

std::string graph_text(const ClosedPath& closed) {
  std::string text = graph_lines_text({closed.places, closed.path});
  for (const ClosedLoop& loop : closed.loops) {
    append_edge(text, loop.from, loop.to, loop.T_from_to, loop.information, loop.weight);
  }
  return text;
}

std::string graph_lines_text(const GraphLines& graph) {
  std::string text;
  for (const GraphPlace& place : graph.places) {
    const Pose2& T = place.T_map_base;
    fmt::format_to(std::back_inserter(text), "VERTEX_SE2 {} {} {} {}\n", place.scan, T.x_m, T.y_m, T.theta_rad);
  }
  for (const PathRelation& relation : graph.relations) {
    append_edge(text, relation.from, relation.to, relation.T_from_to, relation.information, 1.0);
  }
  return text;
}

GraphLines read_graph(const std::string& path) {
  LineReader lines(open_file_source(path), kMostGraphLine);
  GraphLines graph;
  while (const std::optional<TextLine> line = lines.next()) {
    const FilePosition position{path, line->number};
    if (line->is_too_long) throw InputError(position, "is too long for a line of a graph");
    if (line->text.empty()) continue;
    read_graph_line(line->text, position, graph);
    check_kept_bytes(graph.places.size() * sizeof(GraphPlace) + graph.relations.size() * sizeof(PathRelation),
                     lines.source().bytes_from_file(), path);
  }
  return graph;
}

}  // namespace gdtslam
