#include "ndt_map.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

#include "to_position.hpp"

namespace gdtslam {
namespace {

constexpr double kStepsOfACube = 4096.0;  // of a cube's edge
constexpr std::int64_t kFarthest = std::int64_t{1} << 20U;
constexpr unsigned kPlaceBits = 21;
constexpr double kLeastShare =
    1.0e-3;  // least variance as a share of the largest: else a flat cube would hold too much

/// Mean and covariance in steps, from the cube's centre.
struct CubeMoments {
  Point3 mean = Point3::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

CubeMoments cube_moments(const NdtSums& sums) {
  const auto count = static_cast<double>(sums.count);
  CubeMoments moments;
  for (int k = 0; k < 3; ++k) moments.mean[k] = static_cast<double>(sums.sum[static_cast<std::size_t>(k)]) / count;
  std::size_t next = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      const double mean_product = static_cast<double>(sums.products[next++]) / count;
      moments.covariance(i, j) = (mean_product - moments.mean[i] * moments.mean[j]) * count / (count - 1.0);
      moments.covariance(j, i) = moments.covariance(i, j);
    }
  }
  return moments;
}

}  // namespace

NdtMap::NdtMap(std::span<const CloudPoint> cloud, double cell_m, double noise_m) : cell_m_(cell_m) {
  const double step_m = cell_m / kStepsOfACube;
  std::vector<Place> places;
  for (const CloudPoint& given : cloud) {
    const Point3 point = to_position(given);
    const Place place = place_of(point);
    if (std::any_of(place.begin(), place.end(), [](std::int64_t p) { return std::abs(p) >= kFarthest; })) continue;
    const Point3 from_centre = (point - centre_of(place)) / step_m;
    std::array<std::int64_t, 3> steps{};
    for (int k = 0; k < 3; ++k) steps[static_cast<std::size_t>(k)] = std::llround(from_centre[k]);
    const auto [entry, is_new] = sums_.try_emplace(key(place));
    if (is_new) places.push_back(place);
    NdtSums& sums = entry->second;
    ++sums.count;
    std::size_t next = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      sums.sum[i] += steps[i];
      for (std::size_t j = i; j < 3; ++j) sums.products[next++] += steps[i] * steps[j];
    }
  }
  std::sort(places.begin(), places.end());
  for (const Place& place : places) {
    const NdtSums& sums = sums_.at(key(place));
    if (sums.count < kFewestPoints) continue;
    const CubeMoments moments = cube_moments(sums);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(step_m * step_m * moments.covariance);
    const double least = std::max(noise_m * noise_m, kLeastShare * solver.eigenvalues()[2]);
    const Point3 weights = solver.eigenvalues().cwiseMax(least).cwiseInverse();
    of_.emplace(key(place), static_cast<std::uint32_t>(cells_.size()));
    cells_.push_back({centre_of(place) + step_m * moments.mean,
                      solver.eigenvectors() * weights.asDiagonal() * solver.eigenvectors().transpose()});
  }
}

NdtMap::Place NdtMap::place_of(const Point3& point) const {
  Place place{};
  for (int k = 0; k < 3; ++k) {
    const double cell = std::clamp(std::floor(point[k] / cell_m_), -2.0 * kFarthest, 2.0 * kFarthest);
    place[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(cell);
  }
  return place;
}

Point3 NdtMap::centre_of(const Place& place) const {
  return cell_m_ *
         (Point3(static_cast<double>(place[0]), static_cast<double>(place[1]), static_cast<double>(place[2])) +
          Point3::Constant(0.5));
}

std::uint64_t NdtMap::key(const Place& place) {
  std::uint64_t key = 0;
  for (const std::int64_t p : place) key = key << kPlaceBits | static_cast<std::uint64_t>(p + kFarthest);
  return key;
}

NdtSums NdtMap::sums_at(const Point3& point) const {
  const auto found = sums_.find(key(place_of(point)));
  return found == sums_.end() ? NdtSums{} : found->second;
}

}  // namespace gdtslam
