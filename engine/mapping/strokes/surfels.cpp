#include "surfels.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gdtslam {
namespace {

constexpr double kFarthestPoint_m = 1.0e5;  // keys have 21 bits an axis for cells of 10 cm

// Along z the cells begin half an edge below 0: a floor there does not lie between two cells.
std::uint64_t cell_key(const CloudPoint& point, double cell_m) {
  const auto index = [cell_m](double coordinate_m) {
    return static_cast<std::uint64_t>(std::floor(coordinate_m / cell_m) + 0x100000) & 0x1fffffU;
  };
  return index(static_cast<double>(point.x_m)) << 42U | index(static_cast<double>(point.y_m)) << 21U |
         index(static_cast<double>(point.z_m) + 0.5 * cell_m);
}

bool is_near(const CloudPoint& point) {
  const auto is_within = [](float value) { return std::fabs(static_cast<double>(value)) < kFarthestPoint_m; };
  return is_within(point.x_m) && is_within(point.y_m) && is_within(point.z_m);
}

using KeyedPoint = std::pair<std::uint64_t, std::uint32_t>;

Point3 position(const CloudPoint& point) {
  return {static_cast<double>(point.x_m), static_cast<double>(point.y_m), static_cast<double>(point.z_m)};
}

// The points of one cell; empty if they are few or not flat.
std::optional<Surfel> fit_surfel(std::span<const KeyedPoint> cell, const std::vector<CloudPoint>& points,
                                 const SurfelOptions& options) {
  if (cell.size() < options.fewest) return std::nullopt;
  Surfel surfel;
  for (const auto& [key, index] : cell) {
    surfel.mean += position(points[index]);
    surfel.scan += static_cast<double>(points[index].scan);
    surfel.elevation_rad += static_cast<double>(points[index].elevation_rad);
  }
  const auto count = static_cast<double>(cell.size());
  surfel.mean /= count;
  surfel.scan /= count;
  surfel.elevation_rad /= count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& [key, index] : cell) {
    const Point3 off = position(points[index]) - surfel.mean;
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
    if (!scan_ || *scan_ != point.scan) {
      if (!scan_) first_scan_ = point.scan;
      if (const bool was_upward = ends_.is_upward(); ends_.take(point.elevation_rad)) {
        close_stroke(was_upward);
        first_scan_ = point.scan;
      }
      scan_ = point.scan;
    }
    if (seen_++ % every_ != 0 || !is_near(point)) continue;
    if (points_.size() == options_.most_points) {
      std::size_t kept = 0;
      for (std::size_t k = 0; k < points_.size(); k += 2) points_[kept++] = points_[k];
      points_.resize(kept);
      every_ *= 2;
    }
    points_.push_back(point);
  }
}

void SurfelCollector::close_stroke(bool is_upward) {
  std::vector<KeyedPoint> keyed;
  keyed.reserve(points_.size());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    keyed.emplace_back(cell_key(points_[k], options_.cell_m), static_cast<std::uint32_t>(k));
  }
  std::sort(keyed.begin(), keyed.end());
  for (auto begin = keyed.begin(); begin != keyed.end();) {
    const auto end = std::find_if(begin, keyed.end(), [&](const KeyedPoint& one) { return one.first != begin->first; });
    if (std::optional<Surfel> surfel = fit_surfel({begin, end}, points_, options_)) {
      surfel->stroke = static_cast<std::uint32_t>(strokes_.size());
      surfels_.push_back(*surfel);
    }
    begin = end;
  }
  strokes_.push_back({first_scan_, is_upward});
  points_.clear();
  every_ = 1;
  seen_ = 0;
}

std::vector<Surfel> SurfelCollector::finish() {
  close_stroke(ends_.is_upward());
  return std::move(surfels_);
}

}  // namespace gdtslam
