// Normal distributions transform of a cloud [BiberStrasser2003; Magnusson2009]: for each cube of space the number of
// its points, their sum and the sum of their products, in whole numbers of 1/4096 of the cube's edge. Whole sums do not
// depend on the order of the points. Frame: that of the cloud, metres. Constant, thread-safe. Cost: O(points) to make;
// 80 bytes a cube; a look-up visits eight cubes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

/// Count, sum and products (xx, xy, xz, yy, yz, zz) of the points of a cube, from its centre.
struct NdtSums {
  std::int64_t count = 0;
  std::array<std::int64_t, 3> sum{};
  std::array<std::int64_t, 6> products{};
  friend bool operator==(const NdtSums&, const NdtSums&) = default;
};

/// The normal distribution of a cube's points.
struct NdtCell {
  Point3 mean = Point3::Zero();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};

class NdtMap {
 public:
  /// Cubes of fewer points have no distribution.
  static constexpr std::int64_t kFewestPoints = 5;

  /// Points farther than 2^20 cubes from the origin are left out. No cube is thinner than `noise_m`.
  NdtMap(std::span<const CloudPoint> cloud, double cell_m, double noise_m);

  [[nodiscard]] double cell_m() const { return cell_m_; }
  /// Number of cubes with a distribution.
  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  /// The sums of the cube around a point; without a point all are 0.
  [[nodiscard]] NdtSums sums_at(const Point3& point) const;
  /// Calls see(cell) for those of the eight cubes nearest to a point that have a distribution, in a fixed order.
  template <class See>
  void visit_near(const Point3& point, const See& see) const {
    const Place low = place_of(point - Point3::Constant(0.5 * cell_m_));
    for (int corner = 0; corner < 8; ++corner) {
      const auto cell = of_.find(key({low[0] + (corner & 1), low[1] + (corner >> 1 & 1), low[2] + (corner >> 2)}));
      if (cell != of_.end()) see(cells_[cell->second]);
    }
  }

 private:
  using Place = std::array<std::int64_t, 3>;
  [[nodiscard]] Place place_of(const Point3& point) const;
  [[nodiscard]] Point3 centre_of(const Place& place) const;
  static std::uint64_t key(const Place& place);

  double cell_m_;
  std::unordered_map<std::uint64_t, NdtSums> sums_;
  std::unordered_map<std::uint64_t, std::uint32_t> of_;  // index of the cell of each cube that has one
  std::vector<NdtCell> cells_;
};

}  // namespace gdtslam
