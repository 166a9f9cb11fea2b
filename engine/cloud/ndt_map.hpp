// Normal distributions transform of a cloud [BiberStrasser2003; Magnusson2009]: for each cube of space the number of
// its points, their sum and the sum of their products, in whole numbers of 1/1024 of the cube's edge. Whole sums do not
// depend on the order of the points, and two maps merge into what one map of all their points is. Frame: that of the
// cloud, metres. One object belongs to one thread while it grows. Cost: O(points); some 130 bytes of memory a cube.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

/// Count, sum and products (xx, xy, xz, yy, yz, zz) of the points of a cube, from its centre, in steps.
struct NdtSums {
  std::int64_t count = 0;
  std::array<std::int64_t, 3> sum{};
  std::array<std::int64_t, 6> products{};
  void add(const NdtSums& other);
  friend bool operator==(const NdtSums&, const NdtSums&) = default;
};

/// Index of a cube along x, y and z; cube 0 begins at the origin.
using NdtPlace = std::array<std::int32_t, 3>;

/// Mean and covariance of a cube's points, metres.
struct NdtMoments {
  Point3 mean = Point3::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

class NdtMap {
 public:
  /// Steps in the edge of a cube.
  static constexpr double kStepsOfACube = 1024.0;
  /// Cubes lie less than this many from the origin along each axis.
  static constexpr std::int32_t kFarthest = (1 << 20) - 2;
  /// Most points of a cube, so that no sum overflows.
  static constexpr std::int64_t kMostInACube = std::int64_t{1} << 40U;

  /// True between 1 mm and 1 km.
  static bool is_edge(double cell_m) { return cell_m >= 1.0e-3 && cell_m <= 1.0e3; }
  /// True for less than kFarthest on either side of the origin.
  static bool is_within_limit(const NdtPlace& place);
  /// Throws InputError unless is_edge().
  explicit NdtMap(double cell_m);

  /// Points that are not finite, or farther than kFarthest cubes, are left out and counted.
  void add(std::span<const CloudPoint> points);
  /// Adds the sums of a cube. Throws InputError beyond the limits above.
  void add(const NdtPlace& place, const NdtSums& sums);
  /// Throws InputError if the edges of the cubes differ.
  void merge(const NdtMap& other);

  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] std::size_t size() const { return sums_.size(); }
  [[nodiscard]] std::uint64_t points() const { return points_; }
  [[nodiscard]] std::uint64_t points_left_out() const { return left_out_; }
  /// All cubes with points, sorted by place.
  [[nodiscard]] std::vector<std::pair<NdtPlace, NdtSums>> cubes() const;
  /// The sums of the cube around a point; without a point all are 0.
  [[nodiscard]] NdtSums sums_at(const Point3& point) const;
  /// For at least two points; of one the covariance is 0.
  [[nodiscard]] NdtMoments moments(const NdtPlace& place, const NdtSums& sums) const;

 private:
  double cell_m_;
  std::unordered_map<std::uint64_t, NdtSums> sums_;
  std::uint64_t points_ = 0;
  std::uint64_t left_out_ = 0;
};

/// The place of the cube around a point; kFarthest along an axis beyond the limit.
NdtPlace ndt_place(const Point3& point, double cell_m);
/// A number for each place within the limit, in the places' order.
std::uint64_t ndt_key(const NdtPlace& place);
NdtPlace ndt_place_of_key(std::uint64_t key);

/// How much the points of cubes of at least NdtCells::kFewestPoints points deviate from their cubes' planes, root mean
/// square: what a cloud sampled from the cubes lacks at least.
double plane_deviation_m(const NdtMap& map);

/// Samples the flat patch of each cube with points about `spacing_m` apart, as many as its two largest deviations need.
/// A cube of one point gives that point. Sorted by place.
Cloud sample_cloud(const NdtMap& map, double spacing_m);

/// The distributions of a map's cubes, prepared to match points with. Constant, thread-safe. Cost: 100 bytes a cube; a
/// look-up visits eight cubes.
class NdtCells {
 public:
  /// Cubes of fewer points have no distribution.
  static constexpr std::int64_t kFewestPoints = 5;
  /// Variances in the exponent of a point's score, exp(-q / (2 kWideness)) for a squared Mahalanobis distance q. With
  /// 1, half of the starts that are a metre off end elsewhere.
  static constexpr double kWideness = 3.0;
  struct Cell {
    Point3 mean = Point3::Zero();
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  };

  /// No cube is thinner than `noise_m`.
  NdtCells(const NdtMap& map, double noise_m);

  [[nodiscard]] double cell_m() const { return cell_m_; }
  /// Number of cubes with a distribution.
  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  /// By place, as the map's cubes() that have at least kFewestPoints.
  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  /// Calls see(cell) for those of the eight cubes nearest to a point that have a distribution, in a fixed order.
  template <class See>
  void visit_near(const Point3& point, const See& see) const {
    const NdtPlace low = ndt_place(point - Point3::Constant(0.5 * cell_m_), cell_m_);
    for (int corner = 0; corner < 8; ++corner) {
      const auto cell = of_.find(ndt_key({low[0] + (corner & 1), low[1] + (corner >> 1 & 1), low[2] + (corner >> 2)}));
      if (cell != of_.end()) see(cells_[cell->second]);
    }
  }

 private:
  double cell_m_;
  std::unordered_map<std::uint64_t, std::uint32_t> of_;  // index of the cell of each cube that has one
  std::vector<Cell> cells_;
};

}  // namespace gdtslam
