#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>

#include "engine/core/elementary.hpp"
#include "engine/core/to_position.hpp"
#include "gdtslam/cloud/plane.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "neighbours.hpp"
#include "patch_cells.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostHoughCells = 60'000;
constexpr double kGrowth = 1.3;           // growth of the cells until their number is small enough
constexpr std::uint32_t kNearCells = 24;  // cells whose points determine a normal
constexpr double kFlatPlane = 0.5;        // thickness over extent of a neighbourhood that has a normal
constexpr double kAlike = 0.9;            // cosine of a point's normal to that of its plane
constexpr double kMiss = 0.001;           // probability to miss a plane larger than the one found
constexpr std::uint32_t kLeastCells = 8;
constexpr int kRefinements = 3;
constexpr std::uint32_t kMostFailures = 20;  // successive failed planes before the search ends

/// The thinned copy: a point for each cube, the mean of its points, and its normal.
struct ThinnedCloud {
  PatchCells cells;
  Cloud means;
  std::vector<Point3> normals;  ///< zero if there is none
  std::vector<bool> is_free;    ///< belongs to no plane yet
  PatchCells groups;            ///< larger cubes: cells that touch are connected
};

PatchCells few_cells(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points, double edge_m) {
  PatchCells cells(cloud, points, edge_m);
  while (cells.size() > kMostHoughCells) {
    edge_m = cells.edge_m() * kGrowth;
    cells = PatchCells(cloud, points, edge_m);
  }
  return cells;
}

ThinnedCloud thinned(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points,
                     const PlaneSearch& search) {
  PatchCells cells = few_cells(cloud, points, search.thickness_m);
  Cloud means = cells.cell_means(cloud);
  std::vector<std::uint32_t> all(means.size());
  std::iota(all.begin(), all.end(), 0U);
  PatchCells groups(means, all, std::max(0.5 * search.gap_m, 1.5 * cells.edge_m()));
  groups.link();
  ThinnedCloud result{std::move(cells), std::move(means), {}, std::vector<bool>(all.size(), true), std::move(groups)};
  if (all.empty()) return result;
  const Neighbours neighbours(result.means);
  for (const std::uint32_t k : all) {
    result.normals.push_back(neighbours.patch(k, kNearCells, kFlatPlane).value_or(Neighbours::Patch{}).normal);
  }
  return result;
}

bool is_alike(const ThinnedCloud& thin, std::uint32_t cell, const Plane& plane) {
  return std::fabs(thin.normals[cell].dot(plane.normal)) >= kAlike;
}

// Free cells within the thickness with a similar normal.
std::vector<std::uint32_t> find_supporters(const ThinnedCloud& thin, const Plane& plane, double thickness_m) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t k = 0; k < thin.means.size(); ++k) {
    if (!thin.is_free[k] || std::fabs(plane.distance_m(to_position(thin.means[k]))) > thickness_m) continue;
    if (is_alike(thin, k, plane)) found.push_back(k);
  }
  return found;
}

// Largest connected group of the cells, ascending.
std::vector<std::uint32_t> connected(const ThinnedCloud& thin, const std::vector<std::uint32_t>& cells) {
  const std::vector<std::uint32_t>& group_of = thin.groups.cell_by_point();
  std::vector<bool> is_marked(thin.groups.size(), false);
  for (const std::uint32_t k : cells) is_marked[group_of[k]] = true;
  std::vector<bool> is_kept(thin.groups.size(), false);
  for (const std::uint32_t group : thin.groups.largest_group(is_marked)) is_kept[group] = true;
  std::vector<std::uint32_t> kept;
  for (const std::uint32_t k : cells) {
    if (is_kept[group_of[k]]) kept.push_back(k);
  }
  return kept;
}

bool spans_a_plane(const ThinnedCloud& thin, const std::vector<std::uint32_t>& cells) {
  const Point3 first = to_position(thin.means[cells.front()]);
  Point3 longest = Point3::Zero();
  for (const std::uint32_t k : cells) {
    const Point3 d = to_position(thin.means[k]) - first;
    if (d.squaredNorm() > longest.squaredNorm()) longest = d;
  }
  return std::any_of(cells.begin(), cells.end(), [&](std::uint32_t k) {
    return (to_position(thin.means[k]) - first).cross(longest).norm() > 1.0e-6 * longest.norm();
  });
}

struct Candidate {
  Plane plane;
  std::vector<std::uint32_t> cells;
};

// Grows and refits: from the normal of one point to the plane of all connected cells on it.
Candidate grown(const ThinnedCloud& thin, Plane plane, const std::vector<std::uint32_t>& supporters,
                double thickness_m) {
  Candidate best{plane, connected(thin, supporters)};
  for (int k = 0; k < kRefinements; ++k) {
    if (best.cells.size() < kLeastCells || !spans_a_plane(thin, best.cells)) return best;
    plane = fit_plane(thin.means, best.cells).plane;
    Candidate next{plane, connected(thin, find_supporters(thin, plane, thickness_m))};
    if (next.cells.size() < best.cells.size()) return best;
    best = std::move(next);
  }
  return best;
}

// Trials after which a plane with this share of the free cells has been found, except for the probability kMiss.
double enough_trials(std::size_t cells, std::size_t free) {
  const double share = static_cast<double>(cells) / static_cast<double>(free);
  return share >= 1.0 ? 1.0 : log(kMiss) / log(1.0 - share);
}

std::optional<Candidate> best_candidate(const ThinnedCloud& thin, const PlaneSearch& search, Random& random) {
  std::vector<std::uint32_t> seeds;
  for (std::uint32_t k = 0; k < thin.means.size(); ++k) {
    if (thin.is_free[k] && !thin.normals[k].isZero(0.0)) seeds.push_back(k);
  }
  Candidate best;
  double most = seeds.empty() ? 0.0 : search.trials;
  for (double trial = 0.0; trial < most; trial += 1.0) {
    const std::uint32_t seed = seeds[random.below(seeds.size())];
    const Plane plane{thin.normals[seed], thin.normals[seed].dot(to_position(thin.means[seed]))};
    const std::vector<std::uint32_t> supporters = find_supporters(thin, plane, search.thickness_m);
    if (supporters.size() <= best.cells.size() / 2) continue;  // growing rarely doubles a plane
    Candidate next = grown(thin, plane, supporters, search.thickness_m);
    if (next.cells.size() <= best.cells.size()) continue;
    best = std::move(next);
    most = std::min<double>(search.trials, enough_trials(best.cells.size(), seeds.size()));
  }
  if (best.cells.size() < kLeastCells || !spans_a_plane(thin, best.cells)) return std::nullopt;
  return best;
}

/// The points of a patch, and those used to fit its plane.
struct PatchPoints {
  std::vector<std::uint32_t> all;
  std::vector<std::uint32_t> core;  ///< away from edges
};

// All points near the plane in the cubes of the patch and beside them.
PatchPoints find_patch_points(std::span<const CloudPoint> cloud, const ThinnedCloud& thin, const Plane& plane,
                              const std::vector<bool>& is_taken, const std::vector<bool>& is_of_patch,
                              double thickness_m) {
  PatchPoints found;
  for (std::uint32_t k = 0; k < thin.means.size(); ++k) {
    if (!is_of_patch[thin.groups.cell_by_point()[k]]) continue;
    const bool is_core = is_alike(thin, k, plane);
    for (const std::uint32_t point : thin.cells.cell_points(k)) {
      if (is_taken[point] || std::fabs(plane.distance_m(to_position(cloud[point]))) > thickness_m) continue;
      found.all.push_back(point);
      if (is_core) found.core.push_back(point);
    }
  }
  std::sort(found.all.begin(), found.all.end());
  std::sort(found.core.begin(), found.core.end());
  return found;
}

// The plane refined on all points; empty if too few are left, or if they lie on a line.
std::optional<PlanePatch> fit_patch(std::span<const CloudPoint> cloud, const ThinnedCloud& thin,
                                    const Candidate& candidate, const std::vector<bool>& is_taken,
                                    const PlaneSearch& search) {
  std::vector<bool> is_of_patch(thin.groups.size(), false);
  for (const std::uint32_t k : candidate.cells) is_of_patch[thin.groups.cell_by_point()[k]] = true;
  is_of_patch = thin.groups.grown(is_of_patch);
  Plane plane = candidate.plane;
  PlanePatch patch;
  for (int k = 0; k < kRefinements; ++k) {
    PatchPoints points = find_patch_points(cloud, thin, plane, is_taken, is_of_patch, search.thickness_m);
    if (points.all.size() < std::max<std::size_t>(3, search.min_points)) return std::nullopt;
    std::optional<PlanePatch> fitted =
        fitted_plane(cloud, points.core.size() >= 3 * kLeastCells ? points.core : points.all);
    if (!fitted) return std::nullopt;
    patch = *std::move(fitted);
    plane = patch.plane;
    patch.points = std::move(points.all);
  }
  return patch;
}

Point3 centroid(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points) {
  Point3 sum = Point3::Zero();
  for (const std::uint32_t k : points) sum += to_position(cloud[k]);
  return sum / static_cast<double>(points.size());
}

// Second moments about the centre, divided by the number of points.
Eigen::Matrix3d scatter_matrix(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points,
                               const Point3& centre) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const std::uint32_t k : points) {
    const Point3 d = to_position(cloud[k]) - centre;
    sum += d * d.transpose();
  }
  return sum / static_cast<double>(points.size());
}

// The scatter of points on one line across it is at most the rounding of their coordinates.
bool is_line(const Eigen::Vector3d& extents, const Point3& centre) {
  constexpr double kFloatStep = 1.2e-7;
  const double grain_m = kFloatStep * (centre.norm() + std::sqrt(extents[2]));
  return !(extents[1] > grain_m * grain_m);
}

}  // namespace

std::vector<PlanePatch> find_planes(std::span<const CloudPoint> cloud, const PlaneSearch& search) {
  ThinnedCloud thin = thinned(cloud, usable_points(cloud), search);
  std::vector<bool> is_taken(cloud.size(), false);
  Random random(search.seed);
  std::vector<PlanePatch> patches;
  std::uint32_t failures = 0;
  while (patches.size() < search.max_planes && failures < kMostFailures) {
    const std::optional<Candidate> candidate = best_candidate(thin, search, random);
    if (!candidate) break;
    for (const std::uint32_t k : candidate->cells) thin.is_free[k] = false;
    std::optional<PlanePatch> patch = fit_patch(cloud, thin, *candidate, is_taken, search);
    failures = patch ? 0 : failures + 1;
    if (!patch) continue;
    for (const std::uint32_t point : patch->points) is_taken[point] = true;
    patches.push_back(std::move(*patch));
  }
  return patches;
}

// The direction of least scatter; its error follows from the noise about the plane and the extent within it.
std::optional<PlanePatch> fitted_plane(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points) {
  if (points.size() < 3) return std::nullopt;
  PlanePatch patch;
  patch.centre = centroid(cloud, points);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter_matrix(cloud, points, patch.centre));
  const Eigen::Vector3d extents = solver.eigenvalues().cwiseMax(0.0);  // ascending
  if (is_line(extents, patch.centre)) return std::nullopt;
  patch.points.assign(points.begin(), points.end());
  patch.plane.normal = solver.eigenvectors().col(0).normalized();
  patch.plane.offset_m = patch.plane.normal.dot(patch.centre);
  const auto count = static_cast<double>(points.size());
  patch.rms_m = std::sqrt(extents[0]);
  const double sigma_m = std::sqrt(extents[0] * count / std::max(1.0, count - 3.0));
  patch.sigma_centre_m = sigma_m / std::sqrt(count);
  Eigen::Vector3d parts_m(patch.sigma_centre_m, 0.0, 0.0);
  for (const int axis : {1, 2}) {  // turns of the normal; the lever is the centre's distance from the foot point
    parts_m[axis] = solver.eigenvectors().col(axis).dot(patch.centre) * sigma_m / std::sqrt(count * extents[axis]);
  }
  patch.sigma_offset_m = parts_m.norm();
  patch.sigma_normal_rad = sigma_m / std::sqrt(count * extents[1]);
  return patch;
}

PlanePatch fit_plane(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> points) {
  std::optional<PlanePatch> patch = fitted_plane(cloud, points);
  if (!patch) throw InputError("a plane needs at least three points that are not on one line");
  return *std::move(patch);
}

}  // namespace gdtslam
