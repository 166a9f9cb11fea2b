#include "cloud_alignment.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/to_position.hpp"
#include "gdtslam/core/error.hpp"
#include "ndt_map.hpp"
#include "ndt_scorer.hpp"
#include "neighbours.hpp"
#include "registration.hpp"

namespace gdtslam {
namespace {

constexpr std::array kCells_m{2.0, 1.0, 0.5, 0.25};
constexpr double kLeastThickness_m = 0.01;
constexpr double kLeastWeight = 1.0e-3;
constexpr int kMostSteps = 30;
constexpr double kMostStepOfCell = 0.5;
constexpr double kMostTurn_rad = 0.2;
constexpr double kStillOfCell = 4.0e-4;
constexpr double kStillTurn_rad = 2.0e-5;
constexpr std::size_t kMostMoved = 3000;
constexpr double kThinning_m = 0.1;
constexpr double kPlaneThinning_m = 0.03;
constexpr double kPlaneDistance_m = 0.3;
constexpr double kRobust_m = 0.01;
constexpr std::uint32_t kMostPlaneSteps = 100;
constexpr std::uint32_t kPlanePoints = 30'000;
constexpr double kNear_m = 0.3;
constexpr double kOnPlane_m = 0.05;
constexpr double kElsewhere_m = 0.5;
constexpr double kElsewhere_rad = 0.26;
constexpr double kHeightCell_m = 1.0;
constexpr int kHeights = 20;
constexpr double kHeightStep_m = 0.15;
constexpr std::uint32_t kPlaneNeighbours = 12;
constexpr double kFlatAround = 0.3;
constexpr std::size_t kFewestOfACloud = 100;

std::vector<Point3> to_positions(const Cloud& cloud) {
  std::vector<Point3> points;
  points.reserve(cloud.size());
  for (const CloudPoint& point : cloud) points.push_back(to_position(point));
  return points;
}

// Evenly over the surfaces, and near them: means of small cubes, of which every n-th is taken.
Cloud thinned_to(std::span<const CloudPoint> cloud, std::size_t most) {
  const Cloud means = means_of_cubes(cloud, kThinning_m);
  const std::size_t every = (means.size() + most - 1) / most;
  Cloud taken;
  for (std::size_t k = 0; k < means.size(); k += every) taken.push_back(means[k]);
  return taken;
}

/// Weighted normal equations about the points' centre; rows are x, y, z and turns about a's axes.
struct NdtEquations {
  Matrix6 information = Matrix6::Zero();
  Tangent3 right = Tangent3::Zero();
};

Point3 mean_point(const std::vector<Point3>& points) {
  Point3 sum = Point3::Zero();
  for (const Point3& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

NdtEquations ndt_equations(const Pose3& T, const std::vector<Point3>& points, const Point3& centre,
                           const NdtCells& map) {
  NdtEquations sums;
  for (const Point3& point : points) {
    const Point3 moved = T * point;
    const Point3 arm = moved - centre;
    Eigen::Matrix<double, 3, 6> motion;
    motion << 1.0, 0.0, 0.0, 0.0, arm.z(), -arm.y(),  //
        0.0, 1.0, 0.0, -arm.z(), 0.0, arm.x(),        //
        0.0, 0.0, 1.0, arm.y(), -arm.x(), 0.0;
    map.visit_near(moved, [&](const NdtCells::Cell& cell) {
      const Point3 off = moved - cell.mean;
      const Point3 pull = cell.information * off;
      const double weight = std::exp(-0.5 * off.dot(pull) / NdtCells::kWideness);
      if (weight < kLeastWeight) return;
      sums.information += weight * motion.transpose() * cell.information * motion;
      sums.right -= weight * motion.transpose() * pull;
    });
  }
  return sums;
}

Tangent3 ndt_step(const NdtEquations& sums, bool is_planar, double cell_m) {
  Matrix6 damped = sums.information;
  for (int k = 0; k < 6; ++k) damped(k, k) += 1.0e-6 * damped(k, k) + 1.0e-9;
  Tangent3 step = Tangent3::Zero();
  if (is_planar) {
    constexpr std::array<Eigen::Index, 3> kPlane{0, 1, 5};
    step(kPlane) = Eigen::Matrix3d(damped(kPlane, kPlane)).ldlt().solve(Eigen::Vector3d(sums.right(kPlane)));
  } else {
    step = damped.ldlt().solve(sums.right);
  }
  const double longest =
      std::max(step.head<3>().norm() / (kMostStepOfCell * cell_m), step.tail<3>().norm() / kMostTurn_rad);
  return longest > 1.0 ? Tangent3(step / longest) : step;
}

// The score of [Magnusson2009] by reweighted least squares, in one size of cubes.
Pose3 ndt_descent(Pose3 T, const std::vector<Point3>& points, const NdtCells& map, bool is_planar) {
  const Point3 middle = mean_point(points);
  for (int k = 0; k < kMostSteps; ++k) {
    const Point3 centre = T * middle;
    const Tangent3 step = ndt_step(ndt_equations(T, points, centre, map), is_planar, map.cell_m());
    if (!step.allFinite()) return T;
    const Eigen::Quaterniond turn = exp_so3(step.tail<3>());
    T = {turn * (T.translation_m - centre) + centre + step.head<3>(), (turn * T.rotation).normalized()};
    if (step.head<3>().norm() < kStillOfCell * map.cell_m() && step.tail<3>().norm() < kStillTurn_rad) return T;
  }
  return T;
}

// The starts at the heights that score best.
void choose_heights(const NdtMap& map, const std::vector<Point3>& points, Backend& backend,
                    std::vector<AlignmentStart>& starts) {
  if (std::none_of(starts.begin(), starts.end(), [](const AlignmentStart& start) { return start.is_height_open; }))
    return;
  NdtScorer scorer(map, kLeastThickness_m, backend);
  for (AlignmentStart& start : starts) {
    if (!start.is_height_open) continue;
    std::vector<Pose3> poses;
    for (int k = -kHeights; k <= kHeights; ++k) {
      poses.push_back(start.T_a_b);
      poses.back().translation_m.z() += kHeightStep_m * k;
    }
    const std::vector<std::uint32_t> scores = scorer.scores(points, poses);
    start.T_a_b = poses[static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin())];
  }
}

CloudFit fit_at(const Pose3& T, const std::vector<Point3>& b, const Neighbours& a) {
  CloudFit fit;
  std::vector<double> distances;
  std::size_t overlapping = 0;
  for (const Point3& point : b) {
    const Point3 moved = T * point;
    const std::optional<std::uint32_t> nearest = a.nearest(moved, kNear_m);
    if (!nearest) continue;
    ++overlapping;
    const std::optional<Neighbours::Patch> patch = a.patch(*nearest, kPlaneNeighbours, kFlatAround);
    if (patch) distances.push_back(std::fabs(patch->distance_m(moved)));
  }
  fit.overlap = static_cast<double>(overlapping) / static_cast<double>(b.size());
  if (distances.empty()) return fit;
  const auto on_planes = std::count_if(distances.begin(), distances.end(), [](double d) { return d < kOnPlane_m; });
  fit.on_planes = static_cast<double>(on_planes) / static_cast<double>(distances.size());
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  fit.median_m = *middle;
  return fit;
}

// The information is about its centre; the position is that of b's origin.
Tangent3 sigma_of(const RegistrationResult& found) {
  const Matrix6 covariance = found.rms_m * found.rms_m * found.information.inverse();
  const Point3 arm = found.T_target_source.translation_m - found.centre;
  Matrix6 to_origin = Matrix6::Identity();
  to_origin.topRightCorner<3, 3>() << 0.0, arm.z(), -arm.y(), -arm.z(), 0.0, arm.x(), arm.y(), -arm.x(), 0.0;
  return (to_origin * covariance * to_origin.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
}

bool is_elsewhere(const Pose3& a, const Pose3& b) {
  const Tangent3 off = log_se3(inverse(a) * b);
  return (a.translation_m - b.translation_m).norm() > kElsewhere_m || off.tail<3>().norm() > kElsewhere_rad;
}

/// A pose that a start led to.
struct Ending {
  Pose3 T_a_b;
  CloudFit fit;
};

// From a start down to the finest cubes, once through all sizes and once through the finer half: large cubes find the
// way from afar, but along a corridor they may also lead away from a good start.
Ending ending_from(const Pose3& start, const std::vector<Point3>& points, const std::vector<NdtCells>& levels,
                   const Neighbours& neighbours, bool is_planar) {
  Ending best;
  for (const std::size_t first : {std::size_t{0}, levels.size() / 2}) {
    Pose3 T = start;
    for (std::size_t k = first; k < levels.size(); ++k) T = ndt_descent(T, points, levels[k], is_planar);
    const Ending ending{T, fit_at(T, points, neighbours)};
    if (first == 0 || ending.fit.score() > best.fit.score()) best = ending;
  }
  return best;
}

// From each start; the best fit first, after the first start if that is kept.
std::vector<Ending> find_endings(std::span<const CloudPoint> a, const std::vector<Point3>& points,
                                 const Neighbours& neighbours, const AlignmentOptions& options, Backend& backend) {
  std::vector<AlignmentStart> starts = options.starts;
  std::vector<NdtCells> levels;
  for (const double cell_m : kCells_m) {
    NdtMap map(cell_m);
    map.add(a);
    if (cell_m == kHeightCell_m) choose_heights(map, points, backend, starts);
    levels.emplace_back(map, kLeastThickness_m);
  }
  if (options.method == AlignmentMethod::kPlane) levels.clear();
  std::vector<Ending> endings;
  endings.reserve(starts.size());
  for (const AlignmentStart& start : starts) {
    endings.push_back(ending_from(start.T_a_b, points, levels, neighbours, options.is_planar));
  }
  std::stable_sort(endings.begin() + (options.is_first_kept ? 1 : 0), endings.end(),
                   [](const Ending& x, const Ending& y) { return x.fit.score() > y.fit.score(); });
  return endings;
}

}  // namespace

Alignment align_clouds(std::span<const CloudPoint> a, std::span<const CloudPoint> b, const AlignmentOptions& options,
                       Backend& backend) {
  if (std::min(a.size(), b.size()) < kFewestOfACloud) {
    throw InputError("a cloud of fewer than " + std::to_string(kFewestOfACloud) + " points has no pose in another");
  }
  const Cloud target = means_of_cubes(a, kPlaneThinning_m);
  const Neighbours neighbours(target);
  const std::vector<Point3> points = to_positions(thinned_to(b, kMostMoved));
  const std::vector<Ending> endings = find_endings(a, points, neighbours, options, backend);
  Alignment found;
  found.is_first_kept = options.is_first_kept;
  found.T_a_b = endings.front().T_a_b;
  const auto other = std::find_if(endings.begin(), endings.end(),
                                  [&](const Ending& ending) { return is_elsewhere(ending.T_a_b, found.T_a_b); });
  if (other != endings.end()) {
    found.T_a_b_elsewhere = other->T_a_b;
    found.elsewhere = other->fit;
  }
  // The planes are also asked if only NDT is wanted: their equations show what is held.
  RegistrationOptions by_planes;
  by_planes.max_distance_m = kPlaneDistance_m;
  by_planes.robust_m = kRobust_m;
  by_planes.max_iterations = kMostPlaneSteps;
  by_planes.max_points = kPlanePoints;
  by_planes.start = found.T_a_b;
  by_planes.is_planar = options.is_planar;
  const RegistrationResult planes = register_clouds(means_of_cubes(b, kPlaneThinning_m), target, by_planes);
  if (options.method != AlignmentMethod::kNdt) found.T_a_b = planes.T_target_source;
  found.sigma = sigma_of(planes);
  found.weakest = planes.weakest;
  found.weakest_share = planes.weakest_share;
  found.is_settled = planes.converged;
  found.before = fit_at(options.starts.front().T_a_b, points, neighbours);
  found.after = fit_at(found.T_a_b, points, neighbours);
  return found;
}

}  // namespace gdtslam
