#include "ndt_scorer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kMostCubes = 1 << 26;
constexpr double kStepsPerUnit = 8.0;
constexpr double kBestScore = 1000.0;

// exp(-q / (2 kWideness)) at the middle of each step; the last one is 0.
std::array<std::uint32_t, NdtCost::kSteps> score_table() {
  std::array<std::uint32_t, NdtCost::kSteps> table{};
  for (std::size_t k = 0; k + 1 < table.size(); ++k) {
    const double q = (static_cast<double>(k) + 0.5) / kStepsPerUnit;
    table.at(k) = static_cast<std::uint32_t>(std::lround(kBestScore * std::exp(-0.5 * q / NdtCells::kWideness)));
  }
  return table;
}

/// The cubes that have distributions, and the box around them.
struct CubeBox {
  std::vector<NdtPlace> places;
  NdtPlace low{};
  std::array<std::size_t, 3> size{1, 1, 1};
  explicit CubeBox(const NdtMap& map) {
    for (const auto& [place, sums] : map.cubes()) {
      if (sums.count >= NdtCells::kFewestPoints) places.push_back(place);
    }
    if (places.empty()) return;
    low = places.front();
    NdtPlace high = low;
    for (const NdtPlace& place : places) {
      for (std::size_t k = 0; k < low.size(); ++k) {
        low.at(k) = std::min(low.at(k), place.at(k));
        high.at(k) = std::max(high.at(k), place.at(k));
      }
    }
    double cubes = 1.0;
    for (std::size_t k = 0; k < low.size(); ++k) {
      size.at(k) = static_cast<std::size_t>(high.at(k) - low.at(k)) + 1;
      cubes *= static_cast<double>(size.at(k));
    }
    if (cubes > kMostCubes || *std::max_element(size.begin(), size.end()) > 65'536) {
      throw InputError(
          "a cloud that fills a box of more than 2^26 cubes of a metre is too large to be searched; cut it");
    }
  }
  [[nodiscard]] std::vector<std::int32_t> numbers() const {
    std::vector<std::int32_t> numbers(size[0] * size[1] * size[2], NdtCost::kNone);
    for (std::size_t k = 0; k < places.size(); ++k) {
      std::array<std::size_t, 3> at{};
      for (std::size_t i = 0; i < at.size(); ++i) at.at(i) = static_cast<std::size_t>(places[k].at(i) - low.at(i));
      numbers[(at[2] * size[1] + at[1]) * size[0] + at[0]] = static_cast<std::int32_t>(k);
    }
    return numbers;
  }
};

NdtCost::Distribution to_distribution(const NdtCells::Cell& cell, const Point3& origin) {
  const Eigen::Vector3f mean = (cell.mean - origin).cast<float>();
  const Eigen::Matrix3f information = cell.information.cast<float>();
  return {.mean_x = mean.x(),
          .mean_y = mean.y(),
          .mean_z = mean.z(),
          .xx = information(0, 0),
          .xy = information(0, 1),
          .xz = information(0, 2),
          .yy = information(1, 1),
          .yz = information(1, 2),
          .zz = information(2, 2)};
}

NdtCost::Pose to_single(const Pose3& T) {
  NdtCost::Pose pose;
  const Eigen::Matrix3d R = rotation_matrix(T.rotation);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.rotation[3 * i + j] = static_cast<float>(R(i, j));
    pose.translation_m[i] = static_cast<float>(T.translation_m[i]);
  }
  return pose;
}

template <class Item>
Buffer uploaded(Backend& backend, std::span<const Item> items) {
  Buffer buffer = backend.allocate(std::max<std::size_t>(4, items.size_bytes()));
  if (!items.empty()) backend.upload(buffer, std::as_bytes(items));
  return buffer;
}

}  // namespace

NdtScorer::NdtScorer(const NdtMap& map, double noise_m, Backend& backend) : backend_(&backend) {
  const CubeBox box(map);
  const NdtCells cells(map, noise_m);
  const Eigen::Vector3f origin = (map.cell_m() * Point3(box.low[0], box.low[1], box.low[2])).cast<float>();
  std::vector<NdtCost::Distribution> distributions;
  for (const NdtCells::Cell& cell : cells.cells())
    distributions.push_back(to_distribution(cell, origin.cast<double>()));
  params_ = {.size_x = static_cast<std::uint32_t>(box.size[0]),
             .size_y = static_cast<std::uint32_t>(box.size[1]),
             .size_z = static_cast<std::uint32_t>(box.size[2]),
             .distribution_count = static_cast<std::uint32_t>(distributions.size()),
             .origin_x_m = origin.x(),
             .origin_y_m = origin.y(),
             .origin_z_m = origin.z(),
             .cubes_per_m = static_cast<float>(1.0 / map.cell_m()),
             .steps_per_unit = static_cast<float>(kStepsPerUnit)};
  const std::vector<std::uint32_t> words = make_ndt_map(score_table(), distributions, box.numbers());
  map_ = uploaded(backend, std::span<const std::uint32_t>(words));
}

std::vector<std::uint32_t> NdtScorer::scores(std::span<const Point3> points, std::span<const Pose3> poses) {
  std::vector<std::uint32_t> scores(poses.size());
  if (poses.empty()) return scores;
  std::vector<NdtCost::Point> single;
  single.reserve(points.size());
  for (const Point3& point : points) {
    single.push_back({static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z())});
  }
  std::vector<NdtCost::Pose> single_poses;
  for (const Pose3& T : poses) single_poses.push_back(to_single(T));
  NdtCost::Params params = params_;
  params.point_count = static_cast<std::uint32_t>(single.size());
  const Buffer given = uploaded(*backend_, std::span<const NdtCost::Point>(single));
  const Buffer tried = uploaded(*backend_, std::span<const NdtCost::Pose>(single_poses));
  const Buffer sums = backend_->allocate(scores.size() * sizeof(scores.front()));
  run<NdtCost>(*backend_, params, {static_cast<std::uint32_t>(scores.size()), 1, 1}, map_, given, tried, sums);
  backend_->download(sums, std::as_writable_bytes(std::span(scores)));
  return scores;
}

}  // namespace gdtslam
