// How far apart the points of a cloud lie, place by place: points are counted in cubes, and a surface that crosses a
// cube shares its area among them. 12 bytes a cube; O(points).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gdtslam/core/cloud.hpp"

namespace gdtslam {

class CloudDensity {
 public:
  CloudDensity(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn, double cube_m);
  /// Mean distance between neighbours around a point of the cloud, metres; at most the cube's edge.
  [[nodiscard]] float spacing_m(const CloudPoint& point) const;

 private:
  struct Slot {
    std::uint64_t key = kFree;
    std::uint32_t count = 0;
  };
  static constexpr std::uint64_t kFree = ~std::uint64_t{0};
  [[nodiscard]] std::uint64_t key_of(const CloudPoint& point) const;
  /// The slot of the key, or the free one where it belongs.
  [[nodiscard]] std::size_t place_of(std::uint64_t key) const;
  void count(std::uint64_t key);
  void grow();

  double cube_m_;
  std::vector<Slot> slots_;
  std::size_t taken_ = 0;
};

/// The gaps between points that their discs should close: the spacing around each point, measured in cubes that hold
/// several points, but no more than a little above what is common in the cloud; points farther apart lie alone and are
/// shown so.
class CloudGaps {
 public:
  CloudGaps(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn, double longest_side_m);
  [[nodiscard]] double at_m(const CloudPoint& point) const;
  [[nodiscard]] bool is_alone(const CloudPoint& point) const;

 private:
  std::optional<CloudDensity> density_;
  double largest_m_ = 0.0;
};

}  // namespace gdtslam
