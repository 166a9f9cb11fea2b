#include "reproduce_paper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace gdtslam::reproduce {

std::string label_of(MatcherKind method) {
  const auto* const column =
      std::find_if(kPaper.begin(), kPaper.end(), [method](const PaperColumn& known) { return known.method == method; });
  return std::string(column == kPaper.end() ? gdtslam::name_of(method) : column->name);
}

std::string cm_text(const ErrorSummary& error_m) {
  return fmt::format("{:.2f} \u00b1 {:.2f}", 100.0 * error_m.mean, 100.0 * error_m.deviation);
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
