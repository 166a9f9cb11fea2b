#include "ndt_map.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/core/to_position.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr unsigned kPlaceBits = 21;  // three of them in a word; places are below 2^20, with one more beside
constexpr std::int64_t kPlaceOffset = std::int64_t{1} << (kPlaceBits - 1);
constexpr double kLeastShare =
    1.0e-3;                         // least variance as a share of the largest: else a flat cube would hold too much
constexpr int kMostOnASide = 1024;  // points of a patch

Point3 cube_centre(const NdtPlace& place, double cell_m) {
  return cell_m * (Point3(place[0], place[1], place[2]) + Point3::Constant(0.5));
}

NdtSums sums_of_point(const Point3& steps) {
  std::array<std::int64_t, 3> whole{};
  for (int k = 0; k < 3; ++k) whole.at(static_cast<std::size_t>(k)) = std::llround(steps[k]);
  NdtSums sums{.count = 1, .sum = whole};
  std::size_t next = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) sums.products.at(next++) = whole.at(i) * whole.at(j);
  }
  return sums;
}

// A grid on the plane of the two largest deviations. A uniform patch has a side of sqrt(12) standard deviations.
void add_patch(const NdtMoments& moments, double spacing_m, Cloud& cloud) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance);
  std::array<double, 2> side_m{};
  std::array<int, 2> count{};
  for (std::size_t k = 0; k < 2; ++k) {
    side_m.at(k) = std::sqrt(12.0 * std::max(0.0, solver.eigenvalues()[static_cast<Eigen::Index>(k + 1)]));
    count.at(k) = std::clamp(static_cast<int>(std::lround(std::min(side_m.at(k) / spacing_m, 1.0e6))), 1, kMostOnASide);
  }
  const auto along = [&](std::size_t k, int i) {
    const double share = (i + 0.5) / count.at(k) - 0.5;
    return Point3(side_m.at(k) * share * solver.eigenvectors().col(static_cast<Eigen::Index>(k + 1)));
  };
  for (int i = 0; i < count[0]; ++i) {
    for (int j = 0; j < count[1]; ++j) cloud.push_back(to_cloud_point(moments.mean + along(0, i) + along(1, j)));
  }
}

}  // namespace

void NdtSums::add(const NdtSums& other) {
  count += other.count;
  for (std::size_t k = 0; k < sum.size(); ++k) sum.at(k) += other.sum.at(k);
  for (std::size_t k = 0; k < products.size(); ++k) products.at(k) += other.products.at(k);
}

NdtPlace ndt_place(const Point3& point, double cell_m) {
  NdtPlace place{};
  for (int k = 0; k < 3; ++k) {
    const double cell = std::clamp(std::floor(point[k] / cell_m), -1.0 * NdtMap::kFarthest, 1.0 * NdtMap::kFarthest);
    place.at(static_cast<std::size_t>(k)) = std::isnan(cell) ? NdtMap::kFarthest : static_cast<std::int32_t>(cell);
  }
  return place;
}

std::uint64_t ndt_key(const NdtPlace& place) {
  std::uint64_t key = 0;
  for (const std::int32_t p : place) key = key << kPlaceBits | static_cast<std::uint64_t>(p + kPlaceOffset);
  return key;
}

NdtPlace ndt_place_of_key(std::uint64_t key) {
  NdtPlace place{};
  for (std::size_t k = 3; k-- > 0; key >>= kPlaceBits) {
    const std::uint64_t low = key & ((std::uint64_t{1} << kPlaceBits) - 1);
    place.at(k) = static_cast<std::int32_t>(static_cast<std::int64_t>(low) - kPlaceOffset);
  }
  return place;
}

bool NdtMap::is_within_limit(const NdtPlace& place) {
  return std::all_of(place.begin(), place.end(), [](std::int32_t p) { return std::abs(p) < kFarthest; });
}

NdtMap::NdtMap(double cell_m) : cell_m_(cell_m) {
  if (!is_edge(cell_m)) {
    throw InputError("the cubes of normal distributions have an edge of 1 mm to 1 km, not " + std::to_string(cell_m) +
                     " m");
  }
}

void NdtMap::add(std::span<const CloudPoint> points) {
  for (const CloudPoint& given : points) {
    const Point3 point = to_position(given);
    const NdtPlace place = ndt_place(point, cell_m_);
    if (!is_within_limit(place)) {
      ++left_out_;
      continue;
    }
    add(place, sums_of_point((point - cube_centre(place, cell_m_)) * (kStepsOfACube / cell_m_)));
  }
}

void NdtMap::add(const NdtPlace& place, const NdtSums& sums) {
  if (!is_within_limit(place)) throw InputError("a cube lies too far from the origin");
  NdtSums& known = sums_[ndt_key(place)];
  if (sums.count > kMostInACube - known.count) throw InputError("too many points in one cube");
  known.add(sums);
  points_ += static_cast<std::uint64_t>(sums.count);
}

void NdtMap::merge(const NdtMap& other) {
  if (other.cell_m_ != cell_m_) throw InputError("normal distributions of cubes of different edges do not merge");
  for (const auto& [key, sums] : other.sums_) add(ndt_place_of_key(key), sums);
  left_out_ += other.left_out_;
}

std::vector<std::pair<NdtPlace, NdtSums>> NdtMap::cubes() const {
  std::vector<std::pair<NdtPlace, NdtSums>> cubes;
  cubes.reserve(sums_.size());
  for (const auto& [key, sums] : sums_) cubes.emplace_back(ndt_place_of_key(key), sums);
  std::sort(cubes.begin(), cubes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return cubes;
}

NdtSums NdtMap::sums_at(const Point3& point) const {
  const auto found = sums_.find(ndt_key(ndt_place(point, cell_m_)));
  return found == sums_.end() ? NdtSums{} : found->second;
}

NdtMoments NdtMap::moments(const NdtPlace& place, const NdtSums& sums) const {
  const auto count = static_cast<double>(sums.count);
  const double step_m = cell_m_ / kStepsOfACube;
  Point3 mean;
  for (int k = 0; k < 3; ++k) mean[k] = static_cast<double>(sums.sum.at(static_cast<std::size_t>(k))) / count;
  NdtMoments moments{.mean = cube_centre(place, cell_m_) + step_m * mean};
  if (sums.count < 2) return moments;
  std::size_t next = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      const double mean_product = static_cast<double>(sums.products.at(next++)) / count;
      moments.covariance(i, j) = step_m * step_m * (mean_product - mean[i] * mean[j]) * count / (count - 1.0);
      moments.covariance(j, i) = moments.covariance(i, j);
    }
  }
  return moments;
}

Cloud sample_cloud(const NdtMap& map, double spacing_m) {
  Cloud cloud;
  for (const auto& [place, sums] : map.cubes()) add_patch(map.moments(place, sums), spacing_m, cloud);
  return cloud;
}

double plane_deviation_m(const NdtMap& map) {
  double sum_squares = 0.0;
  double points = 0.0;
  for (const auto& [place, sums] : map.cubes()) {
    if (sums.count < NdtCells::kFewestPoints) continue;
    const NdtMoments moments = map.moments(place, sums);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance, Eigen::EigenvaluesOnly);
    const auto count = static_cast<double>(sums.count);
    sum_squares += count * std::max(0.0, solver.eigenvalues()[0]);
    points += count;
  }
  return points > 0.0 ? std::sqrt(sum_squares / points) : 0.0;
}

NdtCells::NdtCells(const NdtMap& map, double noise_m) : cell_m_(map.cell_m()) {
  for (const auto& [place, sums] : map.cubes()) {
    if (sums.count < kFewestPoints) continue;
    const NdtMoments moments = map.moments(place, sums);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance);
    const double least = std::max(noise_m * noise_m, kLeastShare * solver.eigenvalues()[2]);
    const Point3 weights = solver.eigenvalues().cwiseMax(least).cwiseInverse();
    of_.emplace(ndt_key(place), static_cast<std::uint32_t>(cells_.size()));
    cells_.push_back({moments.mean, solver.eigenvectors() * weights.asDiagonal() * solver.eigenvectors().transpose()});
  }
}

}  // namespace gdtslam
