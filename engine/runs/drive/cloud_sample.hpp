// A sample of a stream of points of unknown length. Each point has a rank that depends on its number alone. Points of
// low rank are kept, and the limit is lowered whenever the sample is full. So every part of the stream has its share,
// no period of the stream (the beams of a scan) shows, and the sample is the same on every run. One sample belongs to
// one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gdtslam/core/cloud.hpp"

namespace gdtslam {

class CloudSample {
 public:
  /// `most` is at least 1.
  explicit CloudSample(std::size_t most = 400'000) : most_(most) {}
  void add(std::span<const CloudPoint> points) {
    for (const CloudPoint& point : points) {
      const std::uint64_t rank = mixed(seen_++);
      while (rank <= limit_ && points_.size() == most_) halve();
      if (rank > limit_) continue;
      points_.push_back(point);
      ranks_.push_back(rank);
    }
  }
  /// In the order of arrival.
  [[nodiscard]] const Cloud& points() const { return points_; }

 private:
  /// splitmix64 [Steele2014].
  static std::uint64_t mixed(std::uint64_t number) {
    std::uint64_t z = (number + 1) * 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }
  void halve() {
    limit_ /= 2;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      if (ranks_[k] > limit_) continue;
      points_[kept] = points_[k];
      ranks_[kept++] = ranks_[k];
    }
    points_.resize(kept);
    ranks_.resize(kept);
  }

  std::size_t most_;
  std::uint64_t limit_ = ~std::uint64_t{0};
  std::uint64_t seen_ = 0;
  Cloud points_;
  std::vector<std::uint64_t> ranks_;
};

}  // namespace gdtslam
