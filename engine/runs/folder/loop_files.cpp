#include "loop_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "engine/core/quantile.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/line_reader.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kColumns = "stamp_s,xx_m2,xy_m2,xt_m_rad,yy_m2,yt_m_rad,tt_rad2";
constexpr std::size_t kValues = 7;
constexpr std::size_t kMostRowBytes = 4096;
constexpr double kRounding = 1.0e-9;  // excess of a correlation over 1 that counts as rounding
constexpr double kNothing = 1.0e-12;  // a micrometre squared: rounding error of differences of large numbers

[[noreturn]] void refuse_row(const FilePosition& position, const std::string& fault) {
  throw InputError(position, fmt::format("the row {}; a row is `{}`", fault, kColumns));
}

bool is_possible(double covariance, double variance, double other) {
  const double most = std::sqrt(std::fmax(0.0, variance)) * std::sqrt(std::fmax(0.0, other));
  return std::fabs(covariance) <= (1.0 + kRounding) * most + kNothing;
}

StampedCovariance stamped_covariance(std::string_view text, const FilePosition& position) {
  const std::optional<std::vector<double>> row = numbers_in(text, ",");
  if (!row || row->size() != kValues) refuse_row(position, fmt::format("has {}, not 7 numbers", in_quotes(text)));
  const std::vector<double>& n = *row;
  const PoseCovariance c{.xx = n[1], .xy = n[2], .xt = n[3], .yy = n[4], .yt = n[5], .tt = n[6]};
  if (c.xx < -kNothing || c.yy < -kNothing || c.tt < -kNothing) refuse_row(position, "has a variance below zero");
  if (!is_possible(c.xy, c.xx, c.yy) || !is_possible(c.xt, c.xx, c.tt) || !is_possible(c.yt, c.yy, c.tt)) {
    refuse_row(position, "is no covariance: two of its values vary together by more than each of them varies");
  }
  return {n[0], c};
}

}  // namespace

std::string covariance_text(const Trajectory& trajectory, std::span<const PoseCovariance> covariances) {
  std::string text = fmt::format("{}\n", kColumns);
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    const PoseCovariance& c = covariances[i];
    fmt::format_to(std::back_inserter(text), "{:.9f},{},{},{},{},{},{}\n", trajectory[i].stamp_s, c.xx, c.xy, c.xt,
                   c.yy, c.yt, c.tt);
  }
  return text;
}

std::vector<StampedCovariance> read_covariances(const std::string& path) {
  LineReader lines(open_file_source(path), kMostRowBytes);
  std::vector<StampedCovariance> rows;
  bool has_header = false;
  while (const std::optional<TextLine> line = lines.next()) {
    const FilePosition position{path, line->number};
    if (!has_header) {
      if (line->text != kColumns) throw InputError(position, fmt::format("has no header `{}`", kColumns));
      has_header = true;
      continue;
    }
    if (line->is_too_long) refuse_row(position, "is too long");
    rows.push_back(stamped_covariance(line->text, position));
    check_kept_bytes(rows.size() * sizeof(StampedCovariance), lines.source().bytes_from_file(), path);
  }
  if (!has_header) throw InputError({path, 0}, fmt::format("is empty; it begins with the header `{}`", kColumns));
  return rows;
}

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
  constexpr double kMostScanNumber = 1.0e15;  // a double holds whole numbers up to here
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

using Json = nlohmann::ordered_json;

std::vector<UncertainStretch> uncertain_stretches(std::span<const PoseCovariance> covariances) {
  std::vector<UncertainStretch> stretches;
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    const double sigma_m = covariances[i].sigma_m();
    if (sigma_m <= kUncertain_m) continue;
    if (stretches.empty() || stretches.back().to + 1 < i) stretches.push_back({i, i, sigma_m});
    stretches.back().to = i;
    stretches.back().sigma_m = std::max(stretches.back().sigma_m, sigma_m);
  }
  return stretches;
}

std::string uncertain_line(std::span<const PoseCovariance> covariances) {
  const std::vector<UncertainStretch> stretches = uncertain_stretches(covariances);
  if (stretches.empty()) return "";
  std::size_t scans = 0;
  double sigma_m = 0.0;
  for (const UncertainStretch& stretch : stretches) {
    scans += stretch.to - stretch.from + 1;
    sigma_m = std::max(sigma_m, stretch.sigma_m);
  }
  return fmt::format(
      "not to be trusted: {} of {} scans in {} {}, standard deviation up to {:.2g} m; report.json has them\n", scans,
      covariances.size(), stretches.size(), stretches.size() == 1 ? "stretch" : "stretches", sigma_m);
}

Json loops_json(const ClosedPath& closed) {
  Json list = Json::array();
  std::size_t on = 0;
  for (const ClosedLoop& loop : closed.loops) {
    on += loop.is_on ? 1U : 0U;
    list.push_back({{"from", loop.from},
                    {"to", loop.to},
                    {"off_m", loop.off_m},
                    {"off_deg", deg_from_rad(loop.off_rad)},
                    {"weight", loop.weight},
                    {"on", loop.is_on}});
  }
  return {{"found", closed.loops.size()},
          {"on", on},
          {"searches", closed.searches},
          {"pruned", closed.pruned},
          {"pairs", closed.pairs},
          {"rms_m", closed.pairs > 0 ? Json(closed.rms_m) : Json(nullptr)},
          {"closures", list}};
}

Json wheels_json(const WheelReport& wheels) {
  return {{"distance", wheels.distance},
          {"distance_sigma", wheels.sigma_distance},
          {"turn", wheels.turn},
          {"turn_sigma", wheels.sigma_turn},
          {"turn_deg_per_m", deg_from_rad(wheels.turn_rad_per_m)},
          {"turn_deg_per_m_sigma", deg_from_rad(wheels.sigma_rad_per_m)},
          {"variance_factor", wheels.variance_factor},
          {"variance_factor_of_matches", wheels.variance_factor_of_matches}};
}

Json uncertain_json(const ClosedPath& closed, const Trajectory& trajectory) {
  Json list = Json::array();
  std::size_t scans = 0;
  for (const UncertainStretch& stretch : uncertain_stretches(closed.covariances)) {
    scans += stretch.to - stretch.from + 1;
    list.push_back({{"from", stretch.from},
                    {"to", stretch.to},
                    {"from_s", trajectory[stretch.from].stamp_s},
                    {"to_s", trajectory[stretch.to].stamp_s},
                    {"sigma_m", stretch.sigma_m}});
  }
  std::vector<double> sigmas_m;
  for (const PoseCovariance& covariance : closed.covariances) sigmas_m.push_back(covariance.sigma_m());
  std::sort(sigmas_m.begin(), sigmas_m.end());
  return {{"above_m", kUncertain_m},
          {"sigma_median_m", quantile_of_sorted(sigmas_m, 0.5)},
          {"sigma_max_m", sigmas_m.back()},
          {"scans", scans},
          {"stretches", list}};
}

}  // namespace gdtslam
