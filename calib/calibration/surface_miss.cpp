#include <algorithm>
#include <cmath>

#include "calibration_residual.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

// A beam flatter on a surface than this never ends on it in practice.
constexpr double kGrazingIncidence = 1e-9;

// The normal of a surface, pointing away from the scanner, and its derivatives.
struct Normal {
  Point3 along;
  Point3 by_heading = Point3::Zero();
  Point3 by_tilt = Point3::Zero();
};

Normal surface_normal(const CalibrationSurface& surface) {
  switch (surface.kind) {
    case SurfaceKind::kFloor:
      return {.along = {0.0, 0.0, -1.0}, .by_tilt = {1.0, 0.0, 0.0}};
    case SurfaceKind::kCeiling:
      return {.along = {0.0, 0.0, 1.0}, .by_tilt = {-1.0, 0.0, 0.0}};
    case SurfaceKind::kWall:
      break;
  }
  const auto [sin, cos] = sin_cos(surface.heading_rad);
  return {.along = {cos, sin, 0.0}, .by_heading = {-sin, cos, 0.0}, .by_tilt = {0.0, 0.0, -1.0}};
}

// A beam's direction in the nodding frame and its derivatives by the sensor's roll and yaw.
struct Beam {
  Point3 along;
  Point3 by_roll;
  Point3 by_yaw;
};

Beam beam_at(const NoddingMount& mount, double bearing_rad) {
  const auto [sin_bearing, cos_bearing] = sin_cos(bearing_rad);
  const auto [sin_roll, cos_roll] = sin_cos(mount.sensor_roll_rad);
  const auto [sin_yaw, cos_yaw] = sin_cos(mount.sensor_yaw_rad);
  const double left = sin_bearing * cos_roll;
  const double up = sin_bearing * sin_roll;
  const Point3 along{cos_bearing * cos_yaw - left * sin_yaw, cos_bearing * sin_yaw + left * cos_yaw, up};
  return {.along = along, .by_roll = {up * sin_yaw, -up * cos_yaw, left}, .by_yaw = {-along.y(), along.x(), 0.0}};
}

double dot(const Point3& a, const Point3& b) { return a.x() * b.x() + a.y() * b.y() + a.z() * b.z(); }

Point3 lever_vector(const NoddingMount& mount) { return {mount.lever_forward_m, 0.0, mount.lever_up_m}; }

// Converts a vector from the level frame to the nodding frame, which the elevation rotates about the lateral axis.
Point3 in_nodding_frame(const Point3& v, const SinCos<double>& elevation) {
  return {v.x() * elevation.cos + v.z() * elevation.sin, v.y(), v.z() * elevation.cos - v.x() * elevation.sin};
}
Point3 by_elevation(const Point3& v, const SinCos<double>& elevation) {
  return {v.z() * elevation.cos - v.x() * elevation.sin, 0.0, -v.z() * elevation.sin - v.x() * elevation.cos};
}

SurfaceMiss elevation_part(double elevation_rad, int sign, const RockerSensitivity& by_bar, double rate) {
  return {.elevation_rad = elevation_rad,
          .elevation_by_crank = sign * by_bar.crank,
          .elevation_by_coupler = sign * by_bar.coupler,
          .elevation_by_rocker = sign * by_bar.rocker,
          .elevation_by_ground = sign * by_bar.ground,
          .elevation_by_zero = rate};
}

// The surface that a beam meets first; empty if there is none.
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

std::optional<SurfaceMiss> surface_miss(const SweepModel& model, const CalibrationSurface& surface,
                                        const RangeObservation& observation) {
  const double crank = crank_rad(model.encoder, observation.ticks);
  const std::optional<double> elevation = elevation_rad(model, crank);
  const std::optional<RockerSensitivity> by_bar = sensitivity(model.bars, model.assembly, crank);
  const std::optional<double> rate = elevation_rate(model, crank);
  if (!elevation || !by_bar || !rate) return std::nullopt;

  const SinCos<double> turn = sin_cos(*elevation);
  const Normal normal = surface_normal(surface);
  const Beam beam = beam_at(model.mount, observation.bearing_rad);
  const Point3 seen_normal = in_nodding_frame(normal.along, turn);
  const Point3 point = observation.range_m * beam.along + lever_vector(model.mount);

  SurfaceMiss result = elevation_part(*elevation, model.elevation_sign, *by_bar, *rate);
  result.miss_m = dot(seen_normal, point) - surface.distance_m;
  result.incidence = dot(seen_normal, beam.along);
  result.by_elevation = dot(by_elevation(normal.along, turn), point);
  result.by_lever_forward = seen_normal.x();
  result.by_lever_up = seen_normal.z();
  result.by_roll = observation.range_m * dot(seen_normal, beam.by_roll);
  result.by_yaw = observation.range_m * dot(seen_normal, beam.by_yaw);
  result.by_distance = -1.0;
  result.by_heading = dot(in_nodding_frame(normal.by_heading, turn), point);
  result.by_tilt = dot(in_nodding_frame(normal.by_tilt, turn), point);
  return result;
}

std::optional<double> surface_range_m(const NoddingMount& mount, const CalibrationSurface& surface,
                                      double elevation_rad, double bearing_rad) {
  const Point3 normal = in_nodding_frame(surface_normal(surface).along, sin_cos(elevation_rad));
  const double incidence = dot(normal, beam_at(mount, bearing_rad).along);
  const double gap_m = surface.distance_m - dot(normal, lever_vector(mount));
  if (incidence < kGrazingIncidence || gap_m <= 0.0) return std::nullopt;
  return gap_m / incidence;
}

double surface_incidence(const NoddingMount& mount, const CalibrationSurface& surface, double elevation_rad,
                         double bearing_rad) {
  return dot(in_nodding_frame(surface_normal(surface).along, sin_cos(elevation_rad)),
             beam_at(mount, bearing_rad).along);
}

// The miss is A cos(theta) + B sin(theta) + C - d, which is 0 at atan2(B, A) plus or minus an arc cosine.
double measured_elevation_rad(const NoddingMount& mount, const CalibrationSurface& surface,
                              const RangeObservation& observation, double near_rad) {
  const Point3 normal = surface_normal(surface).along;
  const Point3 point = observation.range_m * beam_at(mount, observation.bearing_rad).along + lever_vector(mount);
  const double a = normal.x() * point.x() + normal.z() * point.z();
  const double b = normal.z() * point.x() - normal.x() * point.z();
  const double c = surface.distance_m - normal.y() * point.y();
  const double middle = atan2(b, a);
  const double aside = atan2(std::sqrt(std::max(0.0, a * a + b * b - c * c)), c);
  const double above = wrap_angle(middle + aside);
  const double below = wrap_angle(middle - aside);
  return std::fabs(wrap_angle(above - near_rad)) <= std::fabs(wrap_angle(below - near_rad)) ? above : below;
}

namespace {

// The miss from the surface that the model expects the observation to meet first, which is assigned to it; empty if it
// meets none.
std::optional<double> first_miss(const SweepModel& model, const std::vector<CalibrationSurface>& surfaces,
                                 RangeObservation& seen) {
  const std::optional<double> elevation = elevation_rad(model, crank_rad(model.encoder, seen.ticks));
  if (!elevation) return std::nullopt;
  const std::optional<std::uint32_t> first = first_surface(model, surfaces, *elevation, seen.bearing_rad);
  if (!first) return std::nullopt;
  seen.surface = *first;
  const std::optional<SurfaceMiss> miss = surface_miss(model, surfaces[*first], seen);
  return miss ? std::optional(std::fabs(miss->miss_m)) : std::nullopt;
}

}  // namespace

std::size_t assign_surfaces(const SweepModel& model, const std::vector<CalibrationSurface>& surfaces, double gate_m,
                            std::vector<RangeObservation>& observations) {
  const auto is_off = [&](RangeObservation& seen) {
    const std::optional<double> miss_m = first_miss(model, surfaces, seen);
    return !miss_m || !(*miss_m <= gate_m);
  };
  return std::erase_if(observations, is_off);
}

double mean_miss_m(const SweepModel& model, const std::vector<CalibrationSurface>& surfaces, double most_m,
                   const std::vector<RangeObservation>& observations) {
  if (observations.empty()) return 0.0;
  double sum_m = 0.0;
  for (RangeObservation seen : observations) {
    const std::optional<double> miss_m = first_miss(model, surfaces, seen);
    sum_m += miss_m && *miss_m < most_m ? *miss_m : most_m;
  }
  return sum_m / static_cast<double>(observations.size());
}

}  // namespace gdtslam::calib
