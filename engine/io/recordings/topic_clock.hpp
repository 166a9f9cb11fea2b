// By how much the stamps of two topics differ where each is stamped by a clock of its own, told by the times at which
// their messages were received. Seconds. Not thread-safe; at most kMostSamples numbers are kept.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace gdtslam {

/// Of one topic: what is between a message's stamp and its receipt.
class TopicClock {
 public:
  static constexpr std::size_t kMostSamples = 64;
  /// Messages of one clock are received within this time after their stamps.
  static constexpr double kMostDelay_s = 1.0;

  /// `duration_s`: how long after its stamp a message can have been sent at the earliest.
  void add(double received_s, double stamp_s, double duration_s) {
    if (delays_s_.size() < kMostSamples) delays_s_.push_back(received_s - stamp_s - duration_s);
  }
  [[nodiscard]] bool is_known() const { return !delays_s_.empty(); }
  /// Receipt minus stamp, by the message that was received fastest: the receiver's delays vary, and only ever add.
  /// What is far from the median is a wrong stamp and does not count.
  [[nodiscard]] double offset_s() const {
    std::vector<double> sorted = delays_s_;
    std::sort(sorted.begin(), sorted.end());
    const double median_s = sorted[sorted.size() / 2];
    return *std::find_if(sorted.begin(), sorted.end(),
                         [median_s](double delay_s) { return delay_s > median_s - kMostDelay_s; });
  }

 private:
  std::vector<double> delays_s_;
};

}  // namespace gdtslam
