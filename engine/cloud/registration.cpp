#include "registration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/core/to_position.hpp"
#include "neighbours.hpp"
#include "patch_cells.hpp"

namespace gdtslam {
namespace {

constexpr double kShrink = 0.7;          // factor of the largest distance of a pair, from one iteration to the next
constexpr double kLeastDistance = 0.34;  // least distance as a share of the first one
constexpr double kFlat = 0.3;            // thickness over extent of a neighbourhood that has a normal
constexpr double kStill_m = 1.0e-4;
constexpr double kStill_rad = 2.0e-5;
constexpr std::size_t kLeastPairs = 20;

/// A cloud that others are registered to: its points, a search tree, and patches at the requested points.
class Target {
 public:
  Target(std::span<const CloudPoint> cloud, std::uint32_t neighbours)
      : neighbours_(cloud), patches_(cloud.size()), is_known_(cloud.size(), false), count_(neighbours) {}
  [[nodiscard]] std::optional<std::uint32_t> nearest(const Point3& point, double within_m) const {
    return neighbours_.nearest(point, within_m);
  }
  /// Empty if the neighbourhood of a point is not flat.
  const std::optional<Neighbours::Patch>& patch(std::uint32_t k) {
    if (!is_known_[k]) patches_[k] = neighbours_.patch(k, count_, kFlat);
    is_known_[k] = true;
    return patches_[k];
  }

 private:
  Neighbours neighbours_;
  std::vector<std::optional<Neighbours::Patch>> patches_;
  std::vector<bool> is_known_;
  std::uint32_t count_;
};

/// The normal equations of one iteration.
struct Equations {
  Matrix6 information = Matrix6::Zero();
  Tangent3 right = Tangent3::Zero();
  double sum_squares = 0.0;
  double weight = 0.0;
  std::uint32_t pairs = 0;
  [[nodiscard]] double rms_m() const { return pairs > 0 ? std::sqrt(sum_squares / weight) : 0.0; }
};

// Residual n . (T p - q); a motion exp(v) on the left of T changes it by n . (v_t + v_r x (T p)). Centred, so that
// rotation and translation are separated as well as the points allow.
Equations equations_at(const Pose3& T, const std::vector<Point3>& source, Target& target, const Point3& centre,
                       double within_m, double robust_m) {
  Equations sums;
  for (const Point3& p : source) {
    const Point3 moved = T * p;
    const std::optional<std::uint32_t> k = target.nearest(moved, within_m);
    if (!k) continue;
    const std::optional<Neighbours::Patch>& patch = target.patch(*k);
    if (!patch) continue;
    const double residual = patch->distance_m(moved);
    Tangent3 row;
    row << patch->normal, (moved - centre).cross(patch->normal);
    const double share = robust_m > 0.0 ? 1.0 / (1.0 + residual * residual / (robust_m * robust_m)) : 1.0;
    const double weight = share * share;
    sums.information += weight * row * row.transpose();
    sums.right -= weight * row * residual;
    sums.sum_squares += weight * residual * residual;
    sums.weight += weight;
    ++sums.pairs;
  }
  return sums;
}

std::vector<Point3> spread(std::span<const CloudPoint> cloud, std::uint32_t most) {
  const std::size_t every = std::max<std::size_t>(1, (cloud.size() + most - 1) / most);
  std::vector<Point3> points;
  for (std::size_t k = 0; k < cloud.size(); k += every) points.push_back(to_position(cloud[k]));
  return points;
}

Point3 centroid(const std::vector<Point3>& points) {
  Point3 sum = Point3::Zero();
  for (const Point3& point : points) sum += point;
  return points.empty() ? sum : Point3(sum / static_cast<double>(points.size()));
}

Cloud thinned(std::span<const CloudPoint> cloud, double cell_m) {
  return cell_m > 0.0 ? means_of_cubes(cloud, cell_m) : Cloud(cloud.begin(), cloud.end());
}

double cloud_radius(const std::vector<Point3>& points, const Point3& centre) {
  double sum = 0.0;
  for (const Point3& point : points) sum += (point - centre).squaredNorm();
  return std::sqrt(sum / static_cast<double>(points.size()));
}

void find_weakest(double radius_m, RegistrationResult& result) {
  Tangent3 scale;
  scale << Point3::Ones(), Point3::Constant(1.0 / radius_m);
  const Matrix6 alike = scale.asDiagonal() * result.information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(alike);
  result.weakest_share = std::max(0.0, solver.eigenvalues()[0]) / solver.eigenvalues()[5];
  result.weakest = solver.eigenvectors().col(0);
}

// The least-squares step; in the plane only x, y and yaw move.
Tangent3 solved(const Equations& sums, bool is_planar) {
  if (!is_planar) return sums.information.ldlt().solve(sums.right);
  constexpr std::array<Eigen::Index, 3> kPlane{0, 1, 5};
  Tangent3 step = Tangent3::Zero();
  step(kPlane) = Eigen::Matrix3d(sums.information(kPlane, kPlane)).ldlt().solve(Eigen::Vector3d(sums.right(kPlane)));
  return step;
}

// Converts a motion about the centre to one about the frame's origin.
Pose3 about(const Point3& centre, const Tangent3& step) {
  const Pose3 to_centre{centre, Eigen::Quaterniond::Identity()};
  const Pose3 rotation{step.head<3>(), exp_so3(step.tail<3>())};
  return to_centre * rotation * inverse(to_centre);
}

}  // namespace

Cloud means_of_cubes(std::span<const CloudPoint> cloud, double cell_m) {
  const PatchCells cells(cloud, usable_points(cloud), cell_m);
  return cells.cell_means(cloud);
}

RegistrationResult register_clouds(std::span<const CloudPoint> source, std::span<const CloudPoint> target,
                                   const RegistrationOptions& options) {
  RegistrationResult result;
  if (source.empty() || target.empty()) return result;
  Target map(thinned(target, options.cell_m), options.neighbours);
  const std::vector<Point3> points = spread(thinned(source, options.cell_m), options.max_points);
  const Point3 middle = centroid(points);
  const double radius_m = std::max(1.0e-3, cloud_radius(points, middle));
  const Point3 centre = options.start * middle;
  result.T_target_source = options.start;
  result.centre = centre;
  double within_m = options.max_distance_m;
  for (; result.iterations < options.max_iterations; ++result.iterations) {
    const Equations sums = equations_at(result.T_target_source, points, map, centre, within_m, options.robust_m);
    if (result.iterations == 0) result.rms_before_m = sums.rms_m();
    result.pairs = sums.pairs;
    result.rms_m = sums.rms_m();
    result.information = sums.information;
    if (sums.pairs < kLeastPairs) return result;
    find_weakest(radius_m, result);
    if (result.converged) return result;
    const Tangent3 step = solved(sums, options.is_planar);
    if (!step.allFinite()) return result;
    result.T_target_source = about(centre, step) * result.T_target_source;
    const bool is_narrow = within_m <= kLeastDistance * options.max_distance_m;
    result.converged = is_narrow && step.head<3>().norm() < kStill_m && step.tail<3>().norm() < kStill_rad;
    within_m = std::max(kShrink * within_m, kLeastDistance * options.max_distance_m);
  }
  return result;
}

}  // namespace gdtslam
