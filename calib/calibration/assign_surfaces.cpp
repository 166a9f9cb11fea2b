#include <cmath>

#include "calibration_residual.hpp"

namespace gdtslam::calib {
namespace {

// The surface that a beam meets first; nothing when none.
std::optional<std::uint32_t> first_surface(const SweepModel& model, const std::vector<CalibrationSurface>& surfaces,
                                           double elevation_rad, double bearing_rad) {
  std::optional<std::uint32_t> first;
  double nearest_m = 0.0;
  for (std::uint32_t k = 0; k < surfaces.size(); ++k) {
    const std::optional<double> range_m = surface_range_m(model.mount, surfaces[k], elevation_rad, bearing_rad);
    if (!range_m || (first && *range_m >= nearest_m)) continue;
    first = k;
    nearest_m = *range_m;
  }
  return first;
}

}  // namespace

std::size_t assign_surfaces(const SweepModel& model, const std::vector<CalibrationSurface>& surfaces, double gate_m,
                            std::vector<RangeObservation>& observations) {
  const auto is_off = [&](RangeObservation& seen) {
    const std::optional<double> elevation = elevation_rad(model, crank_rad(model.encoder, seen.ticks));
    if (!elevation) return true;
    const std::optional<std::uint32_t> first = first_surface(model, surfaces, *elevation, seen.bearing_rad);
    if (!first) return true;
    seen.surface = *first;
    const std::optional<SurfaceMiss> miss = surface_miss(model, surfaces[*first], seen);
    return !miss || !(std::fabs(miss->miss_m) <= gate_m);
  };
  return std::erase_if(observations, is_off);
}

}  // namespace gdtslam::calib
