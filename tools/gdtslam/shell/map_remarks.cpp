#include "map_remarks.hpp"

#include <fmt/format.h>

#include "console.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostDoubtsShown = 5;

std::string as_text(const DoubtfulScan& scan) {
  const std::string what = scan.accepted
                               ? fmt::format("the match is taken, {:.3f} m and {:.1f} deg from the prediction",
                                             scan.from_prediction_m, deg_from_rad(scan.from_prediction_rad))
                               : "the prediction is taken";
  return fmt::format("doubtful scan {} at {:.6f} s: {}; {}", scan.index, scan.stamp_s, to_string(scan.reason), what);
}

}  // namespace

void print_warnings(const std::vector<LogReader::Warning>& warnings) {
  for (const LogReader::Warning& warning : warnings) {
    print_remark(fmt::format("warning: {} ({} times; first: {})", warning.kind, warning.count, warning.first));
  }
}

void print_remarks(const MapOutcome& outcome) {
  print_warnings(outcome.warnings);
  for (std::size_t k = 0; k < outcome.doubtful.size() && k < kMostDoubtsShown; ++k) {
    print_remark(as_text(outcome.doubtful[k]));
  }
  if (outcome.doubtful.size() > kMostDoubtsShown) {
    print_remark(
        fmt::format("and {} more doubtful scans; report.json lists all", outcome.doubtful.size() - kMostDoubtsShown));
  }
}

}  // namespace gdtslam
