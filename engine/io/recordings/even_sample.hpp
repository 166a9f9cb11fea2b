// Quantiles of a stream of numbers of any length, out of an even sample. Not thread-safe; at most kMost numbers are
// kept.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gdtslam {

/// Keeps every k-th number, where k is the least power of two of which not too many come.
class EvenSample {
 public:
  static constexpr std::size_t kMost = 512;  // even
  void add(double value) {
    if (seen_++ % every_ != 0) return;
    if (values_.size() == kMost) {
      for (std::size_t k = 0; k < kMost / 2; ++k) values_[k] = values_[2 * k];
      values_.resize(kMost / 2);
      every_ *= 2;
    }
    values_.push_back(value);
  }
  [[nodiscard]] std::uint64_t seen() const { return seen_; }
  /// Of those that were kept, the one with that share of them below; 0 of none.
  [[nodiscard]] double quantile(double share) const {
    if (values_.empty()) return 0.0;
    std::vector<double> sorted = values_;
    const auto rank = static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1) + 0.5);
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(rank), sorted.end());
    return sorted[rank];
  }

 private:
  std::vector<double> values_;
  std::uint64_t seen_ = 0;
  std::uint64_t every_ = 1;
};

}  // namespace gdtslam
