#include "surfels.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <optional>
#include <utility>

#include "cell_key.hpp"
#include "engine/core/to_position.hpp"

namespace gdtslam {
namespace {

// Along z the cells begin half an edge below 0: a floor there does not lie between two cells.
std::uint64_t surfel_cell(const CloudPoint& point, double edge_m) {
  return key_of(cell_around(to_position(point) + Point3(0.0, 0.0, 0.5 * edge_m), edge_m));
}

using KeyedPoint = std::pair<std::uint64_t, std::uint32_t>;

// The points of one cell; empty if they are few or not flat.
std::optional<Surfel> fit_surfel(std::span<const KeyedPoint> cell, const Cloud& points, const SurfelOptions& options) {
  if (cell.size() < options.fewest) return std::nullopt;
  Surfel surfel;
  for (const auto& [key, index] : cell) {
    surfel.mean += to_position(points[index]);
    surfel.scan += static_cast<double>(points[index].scan);
    surfel.elevation_rad += static_cast<double>(points[index].elevation_rad);
  }
  const auto count = static_cast<double>(cell.size());
  surfel.mean /= count;
  surfel.scan /= count;
  surfel.elevation_rad /= count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& [key, index] : cell) {
    const Point3 off = to_position(points[index]) - surfel.mean;
    covariance += off * off.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance / count);
  const Eigen::Vector3d& variances = axes.eigenvalues();
  const double sq_thick = options.thick_m * options.thick_m;
  if (!(variances[0] < options.flat * variances[1] && variances[0] < sq_thick && variances[1] > sq_thick)) {
    return std::nullopt;
  }
  surfel.normal = axes.eigenvectors().col(0);
  return surfel;
}

}  // namespace

void SurfelCollector::add(std::span<const CloudPoint> points) {
  for (const CloudPoint& point : points) {
    if (sample_.ends_before(point)) close_stroke();
    sample_.add(point);
  }
}

void SurfelCollector::close_stroke() {
  const auto [stroke, points] = sample_.take_stroke();
  std::vector<KeyedPoint> keyed;
  keyed.reserve(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!is_finite(points[k])) continue;
    keyed.emplace_back(surfel_cell(points[k], options_.cell_m), static_cast<std::uint32_t>(k));
  }
  std::sort(keyed.begin(), keyed.end());
  for (auto begin = keyed.begin(); begin != keyed.end();) {
    const auto end = std::find_if(begin, keyed.end(), [&](const KeyedPoint& one) { return one.first != begin->first; });
    if (std::optional<Surfel> surfel = fit_surfel({begin, end}, points, options_)) {
      surfel->stroke = static_cast<std::uint32_t>(strokes_.size());
      surfels_.push_back(*surfel);
    }
    begin = end;
  }
  strokes_.push_back(stroke);
}

std::vector<Surfel> SurfelCollector::finish() {
  close_stroke();
  return std::move(surfels_);
}

}  // namespace gdtslam
