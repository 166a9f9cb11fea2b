#include "covariance_file.hpp"

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

constexpr std::string_view kColumns = "stamp_s,xx_m2,xy_m2,xt_m_rad,yy_m2,yt_m_rad,tt_rad2";
constexpr std::size_t kValues = 7;
constexpr std::size_t kMostRowBytes = 4096;
constexpr double kRounding = 1.0e-9;  // by which correlations may exceed 1
constexpr double kNothing = 1.0e-12;  // a micrometre squared: what is left of differences of large numbers

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

}  // namespace gdtslam
