#include "engine/runs/edits/edit_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/core/elementary.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/maps/png.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastExtent_m = 1.0;
constexpr double kMostResidual_m = 1.0;
constexpr double kMostResidualShare = 0.01;  // share of the extent

struct Centroids {
  Point2 map_m{0.0, 0.0};
  Point2 world_m{0.0, 0.0};
};

// Computes relative to the first point, because sums of coordinates with seven digits before the point lose precision.
Centroids find_centroids(const std::vector<PointPair>& points) {
  Centroids sum;
  for (const PointPair& p : points) {
    sum.map_m += p.map_m - points.front().map_m;
    sum.world_m += p.world_m - points.front().world_m;
  }
  const double share = 1.0 / static_cast<double>(points.size());
  return {points.front().map_m + share * sum.map_m, points.front().world_m + share * sum.world_m};
}

double find_extent_m(const std::vector<PointPair>& points) {
  double most = 0.0;
  for (const PointPair& a : points) {
    for (const PointPair& b : points) {
      const double x = a.map_m.x() - b.map_m.x();
      const double y = a.map_m.y() - b.map_m.y();
      most = std::max(most, std::sqrt(x * x + y * y));
    }
  }
  return most;
}

// Names the usual mistake with coordinates from a map or a receiver.
std::string advice_for(double scale) {
  if (scale < 0.01) return "the world has to be metres (easting, northing), not degrees";
  return "measure them again, or swap easting and northing if they are the wrong way round";
}

void check_residuals(const std::vector<PointPair>& points, const Georeference& fit, double extent_m) {
  const auto worst = std::max_element(fit.residuals_m.begin(), fit.residuals_m.end());
  if (*worst <= std::max(kMostResidual_m, kMostResidualShare * extent_m)) return;
  const PointPair& p = points[static_cast<std::size_t>(worst - fit.residuals_m.begin())];
  throw InputError(
      fmt::format("--georeference: the points contradict each other: {},{} lies {:.2f} m from where the "
                  "others put it, and the world has {:.4g} m for each metre of the map; {}",
                  p.map_m.x(), p.map_m.y(), *worst, fit.scale, advice_for(fit.scale)));
}

}  // namespace

Georeference fit_georeference(const std::vector<PointPair>& points) {
  if (points.size() < 2) {
    throw InputError("--georeference: one point says where the map lies, not how it is turned: give two or more");
  }
  const double extent_m = find_extent_m(points);
  if (extent_m < kLeastExtent_m) {
    throw InputError(
        fmt::format("--georeference: all points lie within {:.2f} m of the map, too near each other to "
                    "tell how it is turned: take some that are far apart",
                    extent_m));
  }
  const Centroids centre = find_centroids(points);
  double dot = 0.0;
  double cross = 0.0;
  double squared = 0.0;
  for (const PointPair& p : points) {
    const Point2 a = p.map_m - centre.map_m;
    const Point2 b = p.world_m - centre.world_m;
    dot += a.x() * b.x() + a.y() * b.y();
    cross += a.x() * b.y() - a.y() * b.x();
    squared += a.x() * a.x() + a.y() * a.y();
  }
  const double theta_rad = atan2(cross, dot);
  const auto [sin, cos] = sin_cos(theta_rad);
  Georeference fit;
  fit.scale = std::sqrt(dot * dot + cross * cross) / squared;
  fit.T_world_map = {centre.world_m.x() - (cos * centre.map_m.x() - sin * centre.map_m.y()),
                     centre.world_m.y() - (sin * centre.map_m.x() + cos * centre.map_m.y()), theta_rad};
  double sum = 0.0;
  for (const PointPair& p : points) {
    const Point2 a = p.map_m - centre.map_m;
    const Point2 b = p.world_m - centre.world_m;
    const double x = b.x() - (cos * a.x() - sin * a.y());
    const double y = b.y() - (sin * a.x() + cos * a.y());
    fit.residuals_m.push_back(std::sqrt(x * x + y * y));
    sum += x * x + y * y;
  }
  fit.rms_m = std::sqrt(sum / static_cast<double>(points.size()));
  check_residuals(points, fit, extent_m);
  return fit;
}

void write_map_picture(const std::string& path, const OccupancyMap& map) {
  using Rgba = std::array<std::uint8_t, 4>;
  constexpr Rgba kClear{205, 205, 205, 0};
  constexpr Rgba kWhite{254, 254, 254, 255};
  constexpr Rgba kBlack{0, 0, 0, 255};
  AtomicFile file(path);
  PngWriter png(static_cast<std::uint32_t>(map.geometry.width), static_cast<std::uint32_t>(map.geometry.height),
                PngWriter::Pixels::kRgba8, [&file](std::span<const std::byte> bytes) { file.write(bytes); });
  std::vector<CellState> states(static_cast<std::size_t>(map.geometry.width));
  std::vector<Rgba> row(states.size());
  for (std::int32_t y = map.geometry.height; y-- > 0;) {
    map.read_row(y, states);
    for (std::size_t x = 0; x < states.size(); ++x) {
      row[x] = states[x] == CellState::kUnknown ? kClear : states[x] == CellState::kFree ? kWhite : kBlack;
    }
    png.add_row(std::as_bytes(std::span(row)));
  }
  png.finish();
  file.commit();
}

std::string world_file_text(const GridGeometry& map, const Pose2& T_world_map) {
  const auto [sin, cos] = sin_cos(T_world_map.theta_rad);
  const double x = map.origin_x_m + 0.5 * map.resolution_m;
  const double y = map.origin_y_m + (static_cast<double>(map.height) - 0.5) * map.resolution_m;
  const double step = map.resolution_m;
  // Rows run downwards, opposite to y.
  return fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n", cos * step, sin * step, sin * step, -cos * step,
                     T_world_map.x_m + (cos * x - sin * y), T_world_map.y_m + (sin * x + cos * y));
}

}  // namespace gdtslam
