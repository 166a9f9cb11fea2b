#include "no_return.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "scan_ahead.hpp"
#include "scan_stream.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kRangeBins = 20001;  // centimetres
constexpr std::size_t kMostConstants = 3;
constexpr std::size_t kShortestRow = 3;      // beams with the same range
constexpr std::uint64_t kLeastScans = 10;    // with such rows
constexpr std::uint64_t kMostAbove = 100;    // least ratio of ranges at a certain constant to ranges above it
constexpr float kMoved_m = 0.05F;            // more than the noise of a range
constexpr std::uint64_t kMovedShare = 4;     // least share of moved ranges among those that differ: one in this many
constexpr std::uint64_t kOfferedShare = 20;  // one beam in this many

// Sensors report "no return" as one large constant: a lonely spike at the upper end of the ranges.
bool is_spike(const std::vector<std::uint64_t>& histogram, std::size_t bin, std::uint64_t total) {
  constexpr std::size_t kNeighbourhood = 50;
  constexpr std::uint64_t kRatio = 20;
  if (histogram[bin] < std::max<std::uint64_t>(10, total / 10000)) return false;
  std::vector<std::uint64_t> around;
  for (std::size_t k = bin - std::min(bin, kNeighbourhood); k < std::min(histogram.size(), bin + kNeighbourhood + 1);
       ++k) {
    if (k != bin) around.push_back(histogram[k]);
  }
  std::nth_element(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2), around.end());
  return histogram[bin] > kRatio * around[around.size() / 2];
}

std::vector<std::size_t> constant_bins(const std::vector<std::uint64_t>& histogram, std::uint64_t total) {
  std::size_t highest = histogram.size();
  while (highest > 0 && histogram[highest - 1] == 0) --highest;
  std::vector<std::size_t> found;
  for (std::size_t bin = highest * 4 / 5; bin < highest; ++bin) {
    if (bin >= 100 && is_spike(histogram, bin, total)) found.push_back(bin);
  }
  if (found.size() > kMostConstants) found.clear();  // a wall seen from one place
  return found;
}

// The decimal number in the log: 7.99, not the 7.98999977 of its float32.
double shortest_decimal(float range_m) {
  const std::string text = fmt::format("{}", range_m);
  double value = static_cast<double>(range_m);
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::size_t bin_of_range(float range_m) { return find_bin(static_cast<double>(range_m) * 100.0, kRangeBins); }

}  // namespace

std::optional<NoReturnValue> NoReturns::taken(const ScanConfig& scan) const {
  for (const NoReturnValue& value : below) {
    if (value.is_certain && value.range_m < scan.max_range_m) return value;
  }
  return std::nullopt;
}

std::optional<NoReturnValue> NoReturns::ambiguous(const ScanConfig& scan) const {
  const std::optional<NoReturnValue> certain = taken(scan);
  for (const NoReturnValue& value : below) {
    if (certain && value.range_m >= certain->range_m) break;
    if (value.range_m < scan.max_range_m && value.beams * kOfferedShare >= beams) return value;
  }
  return std::nullopt;
}

std::string no_return_option(const NoReturnValue& value) {
  return fmt::format("--set log.max_range={}m", value.range_m);
}

LogFinding no_return_finding(const NoReturnValue& value, std::uint64_t beams) {
  const double percent = 100.0 * static_cast<double>(value.beams) / static_cast<double>(beams);
  return {.what = fmt::format("ranges of exactly {} m mean that nothing was seen", value.range_m),
          .evidence = fmt::format("{:.1f} % of the beams, in rows, and nothing is farther", percent),
          .options = no_return_option(value),
          .is_mended = true};
}

// A laser at rest also sees the farthest wall at one range, so scans count as evidence only after it has moved.
bool NoReturnFinder::has_moved(const LaserScan& scan, std::size_t laser) {
  std::vector<float>& last = last_m_[laser];
  bool has_moved = last.size() != scan.ranges_m.size();
  if (!has_moved) {
    std::uint64_t other = 0;
    std::uint64_t far = 0;
    for (std::size_t k = 0; k < last.size(); ++k) {
      const float off_m = std::fabs(scan.ranges_m[k] - last[k]);
      if (!(off_m > 0.0F)) continue;
      ++other;
      if (off_m > kMoved_m) ++far;
    }
    has_moved = far > 0 && kMovedShare * far >= other;
  }
  if (has_moved) last = scan.ranges_m;
  return has_moved;
}

// The majority vote of Boyer and Moore: `repeated` is at least the excess of the most frequent range over all others.
void NoReturnFinder::add_row(float range_m, std::uint64_t beams) {
  Seen& seen = seen_cm_[bin_of_range(range_m)];
  if (std::exchange(seen.last_scan, moved_) != moved_) ++seen.scans;
  if (seen.range_m == range_m) {
    seen.repeated += beams;
  } else if (beams > seen.repeated) {
    seen.range_m = range_m;
    seen.repeated = beams - seen.repeated;
  } else {
    seen.repeated -= beams;
  }
}

void NoReturnFinder::add_rows(const LaserScan& scan) {
  ++moved_;
  const std::vector<float>& ranges_m = scan.ranges_m;
  for (std::size_t from = 0; from < ranges_m.size();) {
    std::size_t to = from + 1;
    while (to < ranges_m.size() && ranges_m[to] == ranges_m[from]) ++to;
    const bool is_return = std::isfinite(ranges_m[from]) && !scan.is_at_limit(static_cast<double>(ranges_m[from]));
    if (is_return) {
      seen_cm_[bin_of_range(ranges_m[from])].beams += to - from;
      if (to - from >= kShortestRow) add_row(ranges_m[from], to - from);
    }
    from = to;
  }
}

void NoReturnFinder::add(const LaserScan& scan, std::size_t laser) {
  below_cm_.resize(kRangeBins);
  at_limit_cm_.resize(kRangeBins);
  seen_cm_.resize(kRangeBins);
  beams_ += scan.ranges_m.size();
  if (scan.max_range_m > 0.0) least_limit_m_ = std::min(least_limit_m_, scan.max_range_m);
  for (const float range_m : scan.ranges_m) {
    if (!std::isfinite(range_m)) continue;
    ++(scan.is_at_limit(static_cast<double>(range_m)) ? at_limit_cm_ : below_cm_)[bin_of_range(range_m)];
  }
  if (!is_settled() && has_moved(scan, laser)) add_rows(scan);
}

bool NoReturnFinder::is_certain(std::size_t bin, const std::vector<std::size_t>& constants) const {
  const Seen& seen = seen_cm_[bin];
  if (seen.scans < kLeastScans || 2 * seen.repeated < seen.beams) return false;
  if (shortest_decimal(seen.range_m) > least_limit_m_) return false;
  std::uint64_t above = 0;
  for (std::size_t k = bin + 1; k < seen_cm_.size(); ++k) {
    if (!std::binary_search(constants.begin(), constants.end(), k)) above += seen_cm_[k].beams;
  }
  return kMostAbove * above <= seen.beams;
}

NoReturns NoReturnFinder::finish() const {
  NoReturns found;
  found.beams = beams_;
  if (below_cm_.empty()) return found;
  for (const std::size_t bin : constant_bins(at_limit_cm_, beams_)) {
    found.at_limit_m.push_back(static_cast<double>(bin) / 100.0);
  }
  const std::vector<std::size_t> constants = constant_bins(below_cm_, beams_);
  for (const std::size_t bin : constants) {
    const Seen& seen = seen_cm_[bin];
    const double range_m = seen.repeated > 0 ? shortest_decimal(seen.range_m) : static_cast<double>(bin) / 100.0;
    found.below.push_back({range_m, below_cm_[bin], is_certain(bin, constants)});
  }
  return found;
}

std::vector<LogFinding> take_no_return(const std::vector<std::string>& logs, const ScanRange& range, bool lenient,
                                       Settings& settings, const std::function<bool()>& stop) {
  if (settings.log.max_range_m > 0.0 || !are_plain_files(logs)) return {};
  NoReturnFinder finder;
  try {
    ScanStream scans(logs, read_options_of(settings.log, lenient), range);
    while (!finder.is_settled() && !stop()) {
      const std::optional<ScanRecord> record = scans.next();
      if (!record) break;
      finder.add(record->scan, record->laser);
    }
  } catch (const Error&) {  // the run itself reports the fault of the log
  }
  const NoReturns found = finder.finish();
  const std::optional<NoReturnValue> value = found.taken(settings.mapper.scan);
  if (!value) return {};
  settings.log.max_range_m = value->range_m;
  return {no_return_finding(*value, found.beams)};
}

}  // namespace gdtslam
