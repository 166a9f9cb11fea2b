// The scans of a path by the number of their keyframe. Those that are needed no more are forgotten one by one and leave
// eight bytes behind, since paths go on for days. Thread-safe while nothing is added or forgotten.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/memory/sparing.hpp"
#include "engine/mapping/surface/surface_points.hpp"

namespace gdtslam {

class KeptScans {
 public:
  KeptScans() = default;
  ~KeptScans() = default;
  KeptScans(KeptScans&&) = default;
  KeptScans& operator=(KeptScans&&) = default;
  KeptScans(const KeptScans& other) {
    for (const std::unique_ptr<KeptScan>& scan : other.scans_) {
      scans_.push_back(scan ? std::make_unique<KeptScan>(*scan) : nullptr);
    }
  }
  KeptScans& operator=(const KeptScans& other) { return *this = KeptScans(other); }

  void push_back(KeptScan scan) { push_sparingly(scans_, std::make_unique<KeptScan>(std::move(scan))); }
  void forget(std::size_t keyframe) { scans_[keyframe].reset(); }
  /// The first ones.
  void keep(std::size_t count) { scans_.resize(count); }
  [[nodiscard]] bool has(std::size_t keyframe) const { return scans_[keyframe] != nullptr; }
  /// Scan of a keyframe that was not forgotten.
  [[nodiscard]] const KeptScan& operator[](std::size_t keyframe) const { return *scans_[keyframe]; }
  [[nodiscard]] KeptScan& operator[](std::size_t keyframe) { return *scans_[keyframe]; }
  /// All that were not, in their order; nothing is left.
  std::vector<KeptScan> take() {
    std::vector<KeptScan> taken;
    for (const std::unique_ptr<KeptScan>& scan : std::exchange(scans_, {})) {
      if (scan) taken.push_back(std::move(*scan));
    }
    return taken;
  }

 private:
  std::vector<std::unique_ptr<KeptScan>> scans_;
};

/// Scans to look at, wherever they are kept; these must outlive this.
class ScansOfPath {
 public:
  ScansOfPath() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a view, as std::span is
  ScansOfPath(const KeptScans& kept) : kept_(&kept) {}
  // NOLINTNEXTLINE(google-explicit-constructor)
  ScansOfPath(const std::vector<KeptScan>& all) : all_(all) {}
  /// One that is there; nothing of one that was forgotten.
  [[nodiscard]] const KeptScan& operator[](std::size_t keyframe) const {
    static const KeptScan forgotten;
    if (kept_ == nullptr) return all_[keyframe];
    return kept_->has(keyframe) ? (*kept_)[keyframe] : forgotten;
  }

 private:
  const KeptScans* kept_ = nullptr;
  std::span<const KeptScan> all_;
};

}  // namespace gdtslam
