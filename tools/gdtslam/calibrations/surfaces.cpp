#include "surfaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

using calib::CalibrationSurface;
using calib::RangeObservation;
using calib::SurfaceKind;

constexpr double kNearEdge = 0.1;  // of the extents of the ranges: a guess that a few strays do not move
constexpr std::size_t kMostSurfaces = 16;

std::string trimmed(const std::string& text) {
  const std::size_t from = text.find_first_not_of(" \t");
  return from == std::string::npos ? "" : text.substr(from, text.find_last_not_of(" \t") - from + 1);
}

SurfaceKind kind_of(const std::string& name) {
  if (name == "wall") return SurfaceKind::kWall;
  if (name == "floor") return SurfaceKind::kFloor;
  if (name == "ceiling") return SurfaceKind::kCeiling;
  throw UsageError("--surfaces: '" + name + "' is no surface; there are wall, floor and ceiling");
}

NamedSurface surface_of(const std::string& text) {
  NamedSurface result;
  const std::size_t at = text.find('@');
  const std::size_t equals = text.find('=');
  const std::string name = trimmed(text.substr(0, std::min(at, equals)));
  result.surface.kind = kind_of(name);
  result.surface.name = name;
  if (equals != std::string::npos && equals < at) {
    result.has_distance = true;
    const std::size_t end = at == std::string::npos ? std::string::npos : at - equals - 1;
    result.surface.distance_m = quantity_of("--surfaces", text.substr(equals + 1, end), Unit::kMetre);
    if (!(result.surface.distance_m > 0.0))
      throw UsageError("--surfaces: the distance of " + name + " must be above 0");
  }
  if (at != std::string::npos) {
    if (result.surface.kind != SurfaceKind::kWall)
      throw UsageError("--surfaces: only a wall has a heading, not " + name);
    result.surface.heading_rad = quantity_of("--surfaces", text.substr(at + 1), Unit::kRadian);
  }
  return result;
}

std::vector<NamedSurface> parse(const std::string& text) {
  std::vector<NamedSurface> list;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t end = std::min(text.find(',', from), text.size());
    list.push_back(surface_of(text.substr(from, end - from)));
    from = end + 1;
  }
  if (list.size() > kMostSurfaces) throw UsageError("--surfaces: more than 16 surfaces");
  return list;
}

// "wall", then "wall2", ...: names are what the parameters are called by.
void number_names(std::vector<NamedSurface>& list) {
  for (std::size_t k = 0; k < list.size(); ++k) {
    std::size_t before = 0;
    for (std::size_t i = 0; i < k; ++i) before += list[i].surface.kind == list[k].surface.kind ? 1U : 0U;
    if (before > 0) list[k].surface.name += std::to_string(before + 1);
  }
}

// How far the ranges reach along the surface's normal, in falling order: for a wall its nearest ranges count, because
// no beam meets it nearer than at its foot; for floor and ceiling the farthest do.
double guessed_distance_m(const CalibrationSurface& surface, const calib::SweepModel& start,
                          const std::vector<RangeObservation>& ranges) {
  std::vector<double> reaches_m;
  for (const RangeObservation& range : ranges) {
    const std::optional<double> elevation = calib::elevation_rad(start, calib::crank_rad(start.encoder, range.ticks));
    if (!elevation) continue;
    if (surface.kind == SurfaceKind::kWall) {
      const double aside = std::fabs(wrap_angle(range.bearing_rad - surface.heading_rad));
      if (aside < 0.35) reaches_m.push_back(range.range_m * sin_cos(aside).cos);
      continue;
    }
    const double up_m = range.range_m * sin_cos(range.bearing_rad).cos * sin_cos(*elevation).sin;
    const double reach_m = surface.kind == SurfaceKind::kCeiling ? up_m : -up_m;
    if (reach_m > 0.0) reaches_m.push_back(reach_m);
  }
  if (reaches_m.empty()) {
    throw InputError("no range tells how far " + surface.name + " is; give its distance, as in --surfaces " +
                     surface.name + "=2m");
  }
  const double share = surface.kind == SurfaceKind::kWall ? kNearEdge : 1.0 - kNearEdge;
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(reaches_m.size() - 1));
  std::nth_element(reaches_m.begin(), reaches_m.begin() + place, reaches_m.end());
  return reaches_m[static_cast<std::size_t>(place)];
}

}  // namespace

std::vector<NamedSurface> named_surfaces(const std::string& text) {
  std::vector<NamedSurface> list = parse(text);
  number_names(list);
  return list;
}

std::vector<CalibrationSurface> placed_surfaces(const std::vector<NamedSurface>& named, const calib::SweepModel& start,
                                                const std::vector<RangeObservation>& ranges) {
  std::vector<CalibrationSurface> surfaces;
  for (const NamedSurface& entry : named) {
    surfaces.push_back(entry.surface);
    if (!entry.has_distance) surfaces.back().distance_m = guessed_distance_m(entry.surface, start, ranges);
  }
  return surfaces;
}

}  // namespace gdtslam
