// Where the points of a 3D map go: thinned, floor and ceiling taken out where that is asked for, into a file. Memory
// does not grow with the cloud; what has to be seen as a whole goes through a spool file. One object, one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/runs/outcome.hpp"
#include "gdtslam/runs/settings.hpp"

namespace gdtslam {

class CloudOutput : public CloudSink {
 public:
  /// Writes to `path`; a spool file beside it is gone when this is. Throws FileError, as add() and finish() do.
  CloudOutput(const CloudConfig& config, std::string path);
  ~CloudOutput() override;
  void add(std::span<const CloudPoint> points) override;
  CloudSummary finish();
  [[nodiscard]] const CloudConfig& config() const { return config_; }

 private:
  void coarsen();

  CloudConfig config_;
  std::string path_;
  std::string spool_;  ///< empty: points go straight into the file
  std::unique_ptr<CloudWriter> writer_;
  std::unique_ptr<VoxelThinning> thinning_;
  CloudSummary summary_;
};

// A sample of a stream of points whose length is not known. Each point has a rank that its number alone decides, and
// those of low rank are kept, lower ones whenever the sample is full: every part of the stream has its share, no
// period of the stream (the beams of a scan) shows in it, and it is the same on every run. One sample belongs to one
// thread.

class CloudSample {
 public:
  /// `most` is at least 1.
  explicit CloudSample(std::size_t most = 400'000) : most_(most) {}
  void add(std::span<const CloudPoint> points) {
    for (const CloudPoint& point : points) {
      const std::uint64_t rank = rank_of(seen_++);
      while (rank <= limit_ && points_.size() == most_) halve();
      if (rank > limit_) continue;
      points_.push_back(point);
      ranks_.push_back(rank);
    }
  }
  /// In the order in which they came.
  [[nodiscard]] const Cloud& points() const { return points_; }

 private:
  /// splitmix64 [Steele2014].
  static std::uint64_t rank_of(std::uint64_t number) {
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
