#include "graph_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>

#include "engine/io/byte_source.hpp"
#include "engine/io/decimal.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/line_reader.hpp"
#include "engine/io/message_text.hpp"
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

/// The numbers of a line after its word.
class GraphNumbers {
 public:
  GraphNumbers(std::string_view text, const FilePosition& position)
      : at_(text.data()), end_(at_ + text.size()), position_(position) {}

  std::size_t scan() {
    skip_blanks();
    std::int64_t value = 0;
    const char* const stop = parse_int64(at_, end_, value);
    if (stop == nullptr || value < 0) refuse("the number of a scan");
    at_ = stop;
    return static_cast<std::size_t>(value);
  }
  double number() {
    skip_blanks();
    double value = 0.0;
    const char* const stop = parse_double(at_, end_, value);
    if (stop == nullptr || !std::isfinite(value)) refuse("a finite number");
    at_ = stop;
    return value;
  }
  Pose2 pose() {
    Pose2 pose;
    pose.x_m = number();
    pose.y_m = number();
    pose.theta_rad = number();
    return pose;
  }
  PoseInformation information() {
    PoseInformation i;
    for (double* const value : {&i.xx, &i.xy, &i.xt, &i.yy, &i.yt, &i.tt}) *value = number();
    return i;
  }
  void expect_end() {
    skip_blanks();
    if (at_ != end_) refuse("the end of the line");
  }

 private:
  void skip_blanks() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t')) ++at_;
  }
  [[noreturn]] void refuse(const char* wanted) const {
    const std::string_view rest(at_, static_cast<std::size_t>(end_ - at_));
    throw InputError(position_, fmt::format("has {} where {} should be", in_quotes(rest), wanted));
  }

  const char* at_;
  const char* end_;
  FilePosition position_;
};

void read_graph_line(std::string_view text, const FilePosition& position, GraphLines& graph) {
  const std::string_view word = text.substr(0, text.find_first_of(" \t"));
  GraphNumbers numbers(text.substr(word.size()), position);
  if (word == kVertex) {
    GraphPlace place;
    place.scan = numbers.scan();
    place.T_map_base = numbers.pose();
    graph.places.push_back(place);
  } else if (word == kEdge) {
    PathRelation relation;
    relation.from = numbers.scan();
    relation.to = numbers.scan();
    relation.T_from_to = numbers.pose();
    relation.information = numbers.information();
    graph.relations.push_back(relation);
  } else {
    throw InputError(position,
                     fmt::format("begins with {}, which is neither {} nor {}", in_quotes(word), kVertex, kEdge));
  }
  numbers.expect_end();
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
