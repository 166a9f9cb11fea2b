#include "paper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace gdtslam::reproduce {

std::string label_of(MatcherKind method) {
  const auto* const column =
      std::find_if(kPaper.begin(), kPaper.end(), [method](const PaperColumn& known) { return known.method == method; });
  return std::string(column == kPaper.end() ? gdtslam::to_string(method) : column->name);
}

std::string cm_text(const ErrorSummary& error_m) {
  return fmt::format("{:.2f} \u00b1 {:.2f}", 100.0 * error_m.mean, 100.0 * error_m.deviation);
}

Row time_row(const PaperColumn& paper, double ratio) {
  constexpr double kBand = 1.5;
  const double least = paper.time_least / kBand;
  const double most = paper.time_most * kBand;
  const bool holds = ratio >= least && ratio <= most;
  const double nearest = std::clamp(ratio, paper.time_least, paper.time_most);
  return {fmt::format("{}: time relative to simplex", paper.name), std::string(paper.time),
          fmt::format("{:.2f}", ratio), verdict_of(holds),
          fmt::format("{}{:.2f} times the paper\u2019s factor; rule: {:.1f} to {:.1f}, the factor divided and "
                      "multiplied by {}. CPU time of the whole mapper, so merging counts too",
                      holds ? "" : "differs: ", ratio / nearest, least, most, kBand)};
}

std::string ranking(const std::vector<std::string>& names, const std::vector<double>& values) {
  std::vector<std::size_t> order(names.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&values](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::string text;
  for (const std::size_t k : order) text += (text.empty() ? "" : ", ") + names[k];
  return text;
}

}  // namespace gdtslam::reproduce
