// Ranges that stand for "nothing seen". Sensors report it as a constant: at their stated limit, just below it, or
// without a stated limit. Metres. Memory is bounded. One finder belongs to one thread; O(beams) a scan.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/runs/outcome.hpp"
#include "gdtslam/runs/settings.hpp"

namespace gdtslam {

/// The bin of a value, rounded to the nearest unit; values below zero are in the first bin.
inline std::size_t find_bin(double value, std::size_t bins) {
  const double bin = std::floor(value + 0.5);
  return bin < static_cast<double>(bins - 1) ? static_cast<std::size_t>(std::max(bin, 0.0)) : bins - 1;
}

/// The bin that holds the given share of all counts.
inline std::size_t quantile_bin(const std::vector<std::uint64_t>& histogram, double share) {
  const auto total = std::accumulate(histogram.begin(), histogram.end(), std::uint64_t{0});
  const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(total));
  std::uint64_t sum = 0;
  for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
    sum += histogram[bin];
    if (sum > wanted) return bin;
  }
  return 0;
}

/// A constant below the limit that the log states.
struct NoReturnValue {
  double range_m = 0.0;  ///< value in the log, to the precision of float32
  std::uint64_t beams = 0;
  /// True if no wall explains it: neighbouring beams have exactly this range while the robot moves, nothing is farther,
  /// and no laser states a lower limit, which log.max_range would replace.
  bool is_certain = false;
};

/// All constants of a log.
struct NoReturns {
  std::vector<double> at_limit_m;    ///< at or above the stated limit, to a centimetre
  std::vector<NoReturnValue> below;  ///< ascending
  std::uint64_t beams = 0;           ///< beams of all scans
  /// The value that `map` treats as no return: the lowest certain one, if the mapper would use such ranges.
  [[nodiscard]] std::optional<NoReturnValue> taken(const ScanConfig& scan) const;
  /// The lowest value that may mean no return and is in too many beams to ignore.
  [[nodiscard]] std::optional<NoReturnValue> ambiguous(const ScanConfig& scan) const;
};

/// "--set log.max_range=7.99m".
std::string no_return_option(const NoReturnValue& value);
/// Finding: map treats the value as no return.
LogFinding no_return_finding(const NoReturnValue& value, std::uint64_t beams);

class NoReturnFinder {
 public:
  void add(const LaserScan& scan, std::size_t laser);
  /// True if the laser moved between enough scans to decide which value is certain.
  [[nodiscard]] bool is_settled() const { return moved_ >= kEnoughMoved; }
  [[nodiscard]] NoReturns finish() const;
  /// Counts by centimetre: finite ranges below the stated limit, and ranges at or above it. The last bin is open. Empty
  /// before the first scan.
  [[nodiscard]] const std::vector<std::uint64_t>& below_cm() const { return below_cm_; }
  [[nodiscard]] const std::vector<std::uint64_t>& at_limit_cm() const { return at_limit_cm_; }

 private:
  static constexpr std::uint64_t kEnoughMoved = 1000;
  /// Ranges of one centimetre, in scans between which the laser has moved.
  struct Seen {
    std::uint64_t beams = 0;
    std::uint64_t scans = 0;      ///< with such rows
    std::uint64_t last_scan = 0;  ///< number of the last such scan, counted from 1
    std::uint64_t repeated = 0;   ///< in rows of beams that all have `range_m`, a lower bound
    float range_m = 0.0F;         ///< the range of most such rows
  };
  bool has_moved(const LaserScan& scan, std::size_t laser);
  void add_rows(const LaserScan& scan);
  void add_row(float range_m, std::uint64_t beams);
  [[nodiscard]] bool is_certain(std::size_t bin, const std::vector<std::size_t>& constants) const;

  std::uint64_t beams_ = 0;
  double least_limit_m_ = std::numeric_limits<double>::infinity();  ///< least limit that a scan states
  std::vector<std::uint64_t> below_cm_;
  std::vector<std::uint64_t> at_limit_cm_;
  std::vector<Seen> seen_cm_;
  std::uint64_t moved_ = 0;                           ///< scans in seen_cm_
  std::map<std::size_t, std::vector<float>> last_m_;  ///< by laser: ranges of the last scan that counted in seen_cm_
};

/// Reads the start of the mapped range until the finder is settled, and sets log.max_range to the value taken as no
/// return. Does nothing if log.max_range is stated, if a log is a pipe that can be read only once, or if no value is
/// certain. Once `stop` returns true, the scans read by then count.
std::vector<LogFinding> take_no_return(const std::vector<std::string>& logs, const ScanRange& range, bool lenient,
                                       Settings& settings, const std::function<bool()>& stop);

}  // namespace gdtslam
