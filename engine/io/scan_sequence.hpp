// Finds oddities of a scan compared with the previous one. One object belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

/// Ranges of a scan that were replaced, by kind.
struct RangeRepairs {
  std::uint64_t not_a_number = 0;
  std::uint64_t negative = 0;
};

class ScanSequence {
 public:
  /// Calls warn(kind, detail) for each oddity.
  template <class Warn>
  void check(const LaserScan& scan, const Warn& warn) {
    if (scan.ranges_m.empty()) warn("scan without beams", "it is kept");
    if (previous_) {
      if (scan.ranges_m.size() != previous_->beams) warn("beam count changed", "from that of the scan before");
      if (scan.stamp_s < previous_->stamp_s) {
        warn("backward stamp", "file order is kept");
      } else if (scan.stamp_s == previous_->stamp_s) {
        warn("repeated stamp", "file order is kept");
      }
    }
    previous_ = {scan.stamp_s, scan.ranges_m.size()};
  }

 private:
  struct Previous {
    double stamp_s = 0.0;
    std::size_t beams = 0;
  };
  std::optional<Previous> previous_;
};

}  // namespace gdtslam
