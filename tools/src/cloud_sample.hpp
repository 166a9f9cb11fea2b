// A sample of a stream of points whose length is not known: every n-th, n doubled whenever the sample is full, so that
// it is spread evenly and the same on every run. One sample belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "gdtslam/core/cloud.hpp"

namespace gdtslam {

class CloudSample {
 public:
  explicit CloudSample(std::size_t most = 400'000) : most_(most) {}
  void add(std::span<const CloudPoint> points) {
    for (const CloudPoint& point : points) {
      if (seen_++ % every_ != 0) continue;
      if (points_.size() == most_) halve();
      if ((seen_ - 1) % every_ == 0) points_.push_back(point);
    }
  }
  [[nodiscard]] const Cloud& points() const { return points_; }

 private:
  void halve() {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < points_.size(); k += 2) points_[kept++] = points_[k];
    points_.resize(kept);
    every_ *= 2;
  }

  std::size_t most_;
  std::uint64_t every_ = 1;
  std::uint64_t seen_ = 0;
  Cloud points_;
};

}  // namespace gdtslam
