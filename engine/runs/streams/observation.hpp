// Several lasers of one robot take turns, or scan at the same time. The scans of one period are one observation of one
// pose: together they look all ways at each step, while scans matched one by one look a different way each time. An
// observation holds at most one scan of each laser. Which scans belong together follows from the log alone, so a live
// run and a later one agree. Seconds. Not thread-safe; constant time a scan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// Scans in log order, at least one. The last one's stamp is that of the observation.
using Observation = std::vector<ScanRecord>;

/// Collects scans until each laser that is active has given one. An observation also ends where a laser comes again,
/// where it would last kLongest_s, and before the laser with the longest pause before its scans, so that scans that
/// are close in time stay together. With one laser each scan is an observation at once.
class ObservationCollector {
 public:
  static constexpr double kLongest_s = 1.0;
  static constexpr std::size_t kMostLasers = 64;
  /// A laser is active for so many observations after its last scan.
  static constexpr std::uint64_t kActiveObservations = 5;

  void take(ScanRecord scan);
  /// The log ends: lasers of the next one may have other numbers.
  void end_log();
  /// The next observation that is complete; with `at_end` also the one that is being collected.
  std::optional<Observation> next(bool at_end);

 private:
  struct Laser {
    std::uint64_t last_observation = 0;
    std::optional<double> gap_s;  ///< mean time from the scan before, of whichever laser, to one of this laser
  };
  [[nodiscard]] bool is_active(const Laser& laser) const;
  [[nodiscard]] bool has_scan_of(std::size_t laser) const;
  [[nodiscard]] bool has_room_for(const ScanRecord& scan) const;
  [[nodiscard]] bool is_complete() const;
  Laser& laser_of(std::size_t number);
  void finish();
  void choose_first();

  Observation scans_;  ///< that are being collected
  std::deque<Observation> ready_;
  std::vector<std::pair<std::size_t, Laser>> lasers_;  ///< with their numbers
  std::optional<std::size_t> first_;                   ///< laser with the longest pause before its scans
  std::optional<double> last_stamp_s_;
  std::uint64_t count_ = 0;  ///< of observations
};

}  // namespace gdtslam
