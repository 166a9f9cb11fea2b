#include "neighbours.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <limits>
#include <nanoflann.hpp>
#include <utility>

#include "engine/core/to_position.hpp"

namespace gdtslam {
namespace {

/// The cloud in the interface of nanoflann, hence its names.
struct Points {
  std::vector<Point3> points;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return points[index][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

using Index =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>, Points, 3, std::uint32_t>;

constexpr std::size_t kLeafPoints = 16;

/// Result set in nanoflann's interface that keeps the first of the nearest points within a distance. Branches of the
/// tree that lie farther off are not entered.
class NearestWithin {
 public:
  // nanoflann passes on points closer than the worst one, not equally close ones.
  explicit NearestWithin(double within_m)
      : worst_(std::nextafter(within_m * within_m, std::numeric_limits<double>::infinity())) {}
  [[nodiscard]] bool full() const { return found_.has_value(); }
  bool addPoint(double squared, std::uint32_t index) {  // NOLINT(readability-identifier-naming)
    if (squared < worst_) {
      worst_ = squared;
      found_ = index;
    }
    return true;
  }
  [[nodiscard]] double worstDist() const { return worst_; }  // NOLINT(readability-identifier-naming)
  [[nodiscard]] std::optional<std::uint32_t> found() const { return found_; }

 private:
  double worst_;
  std::optional<std::uint32_t> found_;
};

std::vector<Point3> to_positions(std::span<const CloudPoint> cloud) {
  std::vector<Point3> points;
  points.reserve(cloud.size());
  for (const CloudPoint& point : cloud) points.push_back(to_position(point));
  return points;
}

}  // namespace

struct Neighbours::Tree {
  explicit Tree(std::span<const CloudPoint> points)
      : cloud{to_positions(points)}, index(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafPoints)) {
    index.buildIndex();
  }
  Points cloud;
  Index index;
};

Neighbours::Neighbours(std::span<const CloudPoint> cloud) : tree_(std::make_unique<Tree>(cloud)) {}
Neighbours::~Neighbours() = default;
Point3 Neighbours::point(std::uint32_t k) const { return tree_->cloud.points[k]; }

std::optional<std::uint32_t> Neighbours::nearest(const Point3& point, double within_m) const {
  NearestWithin nearest(within_m);
  const std::array<double, 3> at{point.x(), point.y(), point.z()};
  tree_->index.findNeighbors(nearest, at.data(), nanoflann::SearchParams());
  return nearest.found();
}

std::vector<std::uint32_t> Neighbours::closest(const Point3& point, std::uint32_t most) const {
  const std::size_t count = std::min<std::size_t>(most, tree_->cloud.points.size());
  if (count == 0) return {};
  std::vector<std::uint32_t> found(count);
  std::vector<double> squared(count);
  const std::array<double, 3> at{point.x(), point.y(), point.z()};
  found.resize(tree_->index.knnSearch(at.data(), count, found.data(), squared.data()));
  return found;
}

std::optional<Neighbours::Patch> Neighbours::patch(std::uint32_t k, std::uint32_t count, double flat) const {
  const std::vector<std::uint32_t> near = closest(point(k), count);
  if (near.size() < 5) return std::nullopt;
  Point3 mean = Point3::Zero();
  for (const std::uint32_t other : near) mean += point(other);
  mean /= static_cast<double>(near.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const std::uint32_t other : near) scatter += (point(other) - mean) * (point(other) - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const Eigen::Vector3d extents = solver.eigenvalues().cwiseMax(0.0);
  if (!(extents[0] < flat * flat * extents[1])) return std::nullopt;
  return Patch{mean, Point3(solver.eigenvectors().col(0))};
}

std::vector<std::uint32_t> Neighbours::within(const Point3& point, double distance_m) const {
  std::vector<std::pair<std::uint32_t, double>> matches;
  const std::array<double, 3> at{point.x(), point.y(), point.z()};
  // nanoflann finds points closer than this, not equally close ones.
  const double squared_m2 = std::nextafter(distance_m * distance_m, std::numeric_limits<double>::infinity());
  tree_->index.radiusSearch(at.data(), squared_m2, matches, nanoflann::SearchParams(0, 0.0F, false));
  std::vector<std::uint32_t> found;
  found.reserve(matches.size());
  for (const auto& [k, squared] : matches) found.push_back(k);
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace gdtslam
