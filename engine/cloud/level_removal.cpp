#include "gdtslam/cloud/thinning.hpp"
#include "position_of.hpp"

namespace gdtslam {
namespace {

// Height of a point over a level plane, whichever way its normal points.
double height_over_m(const Plane& plane, const Point3& point) {
  return plane.normal.z() < 0.0 ? -plane.distance_m(point) : plane.distance_m(point);
}

}  // namespace

LevelRemoval::LevelRemoval(const LevelSurfaces& surfaces, double margin_m, CloudSink& next)
    : surfaces_(surfaces), margin_m_(margin_m), next_(next) {}

void LevelRemoval::add(std::span<const CloudPoint> points) {
  kept_.clear();
  for (const CloudPoint& point : points) {
    const Point3 p = position_of(point);
    const bool is_floor = surfaces_.floor && height_over_m(surfaces_.floor->plane, p) <= margin_m_;
    const bool is_ceiling = surfaces_.ceiling && height_over_m(surfaces_.ceiling->plane, p) >= -margin_m_;
    if (!is_floor && !is_ceiling) kept_.push_back(point);
  }
  removed_ += points.size() - kept_.size();
  if (!kept_.empty()) next_.add(kept_);
}

}  // namespace gdtslam
