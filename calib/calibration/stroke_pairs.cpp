#include "stroke_pairs.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace gdtslam::calib {
namespace {

constexpr double kCell_m = 0.25;   // neighbours of a plane lie within one cell around
constexpr double kFlat = 0.02;     // variance across a plane over the smaller one along it
constexpr double kWide_m = 0.015;  // standard deviation along the plane, or neighbours lie in a line

/// A cell of one stroke.
using CellKey = std::tuple<std::uint32_t, std::int64_t, std::int64_t, std::int64_t>;

CellKey key_of(std::uint32_t stroke, const Point3& point) {
  const auto cell = [](double value) { return static_cast<std::int64_t>(std::floor(value / kCell_m)); };
  return {stroke, cell(point.x()), cell(point.y()), cell(point.z())};
}

/// Points sorted by stroke and cell.
class StrokeGrid {
 public:
  StrokeGrid(const std::vector<Point3>& points, const std::vector<std::uint32_t>& strokes) : points_(points) {
    for (std::uint32_t k = 0; k < points.size(); ++k) entries_.emplace_back(key_of(strokes[k], points[k]), k);
    std::sort(entries_.begin(), entries_.end());
  }
  /// Points of a stroke within a cell's size of the place: the nearest, the farthest and evenly between. Not simply the
  /// nearest, which often lie on one line of the scan. Fewer than asked for where there are fewer.
  [[nodiscard]] std::vector<std::uint32_t> around(std::uint32_t stroke, const Point3& place, std::size_t count) const {
    std::vector<std::pair<double, std::uint32_t>> found;
    const auto [own, x, y, z] = key_of(stroke, place);
    for (std::int64_t i = -1; i <= 1; ++i) {
      for (std::int64_t j = -1; j <= 1; ++j) {
        // The cells z - 1 to z + 1 lie one after the other.
        const CellKey first{stroke, x + i, y + j, z - 1};
        const CellKey last{stroke, x + i, y + j, z + 1};
        const auto begin = std::lower_bound(entries_.begin(), entries_.end(), std::pair(first, std::uint32_t{0}));
        for (auto entry = begin; entry != entries_.end() && entry->first <= last; ++entry) {
          const double sq_distance = (points_[entry->second] - place).squaredNorm();
          if (sq_distance <= kCell_m * kCell_m) found.emplace_back(sq_distance, entry->second);
        }
      }
    }
    std::sort(found.begin(), found.end());
    std::vector<std::uint32_t> list;
    if (found.size() < count) return list;
    for (std::size_t k = 0; k < count; ++k) list.push_back(found[k * (found.size() - 1) / (count - 1)].second);
    return list;
  }

 private:
  const std::vector<Point3>& points_;
  std::vector<std::pair<CellKey, std::uint32_t>> entries_;
};

Point3 centre_of(const StrokePair& pair, const std::vector<Point3>& points) {
  Point3 sum = Point3::Zero();
  for (const std::uint32_t k : pair.plane) sum += points[k];
  return sum / static_cast<double>(pair.plane.size());
}

/// The plane through the neighbours.
struct Fitted {
  Point3 normal;
  bool is_flat = false;
};

Fitted fitted(const StrokePair& pair, const std::vector<Point3>& points) {
  const Point3 centre = centre_of(pair, points);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const std::uint32_t k : pair.plane) {
    const Point3 d = points[k] - centre;
    covariance += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance / static_cast<double>(pair.plane.size()));
  const Point3& variances = eigen.eigenvalues();
  return {.normal = eigen.eigenvectors().col(0),
          .is_flat = variances(1) >= kWide_m * kWide_m && variances(0) <= kFlat * variances(1)};
}

}  // namespace

double miss_m(const StrokePair& pair, const std::vector<Point3>& points) {
  Point3 normal = fitted(pair, points).normal;
  if (normal.dot(pair.normal) < 0.0) normal = -normal;
  return normal.dot(points[pair.point] - centre_of(pair, points));
}

std::vector<StrokePair> stroke_pairs(const std::vector<Point3>& points, const std::vector<std::uint32_t>& strokes,
                                     double gate_m, std::uint32_t most) {
  const StrokeGrid grid(points, strokes);
  const std::size_t step = 1 + points.size() / most;
  std::vector<StrokePair> pairs;
  for (std::size_t k = 0; k < points.size(); k += step) {
    const std::vector<std::uint32_t> near = grid.around(strokes[k] + 1, points[k], StrokePair::kNeighbours);
    if (near.size() < StrokePair::kNeighbours || (points[near.front()] - points[k]).norm() > gate_m) continue;
    StrokePair pair{.point = static_cast<std::uint32_t>(k)};
    std::copy(near.begin(), near.end(), pair.plane.begin());
    const Fitted plane = fitted(pair, points);
    if (!plane.is_flat) continue;
    pair.normal = plane.normal;
    if (std::fabs(miss_m(pair, points)) <= gate_m) pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace gdtslam::calib
