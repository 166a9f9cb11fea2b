#include "cloud_scenes.hpp"

#include <cmath>

namespace gdtslam::test {
namespace {

// Distance along the beam to the rectangle.
std::optional<double> range_to(const Rectangle& rectangle, const Point3& from, const Point3& direction) {
  const Point3 normal = rectangle.normal();
  const double slope = normal.dot(direction);
  if (slope == 0.0) return std::nullopt;
  const double range_m = normal.dot(rectangle.corner - from) / slope;
  if (range_m <= 0.0) return std::nullopt;
  const Point3 d = from + range_m * direction - rectangle.corner;
  const double a = d.dot(rectangle.side) / rectangle.side.squaredNorm();
  const double b = d.dot(rectangle.other) / rectangle.other.squaredNorm();
  if (a < 0.0 || a > 1.0 || b < 0.0 || b > 1.0) return std::nullopt;
  return range_m;
}

}  // namespace

CloudPoint cloud_point(const Point3& point) {
  CloudPoint result;
  result.x_m = static_cast<float>(point.x());
  result.y_m = static_cast<float>(point.y());
  result.z_m = static_cast<float>(point.z());
  return result;
}

void strew(Cloud& cloud, const Rectangle& rectangle, std::size_t count, double noise_m, Random& random) {
  for (std::size_t k = 0; k < count; ++k) {
    // One draw a statement, in the order in which the golden pictures had them.
    const double across = random.uniform();
    const double along = random.uniform();
    const Point3 on = rectangle.corner + along * rectangle.side + across * rectangle.other;
    cloud.push_back(cloud_point(on + random.normal(0.0, noise_m) * rectangle.normal()));
  }
}

void strew_outliers(Cloud& cloud, const Point3& centre, double half_m, std::size_t count, Random& random) {
  for (std::size_t k = 0; k < count; ++k) {
    const double z = random.uniform(-half_m, half_m);
    const double y = random.uniform(-half_m, half_m);
    const Point3 off(random.uniform(-half_m, half_m), y, z);
    cloud.push_back(cloud_point(centre + off));
  }
}

std::vector<Rectangle> room(const Point3& size_m) {
  const Point3 x(size_m.x(), 0.0, 0.0);
  const Point3 y(0.0, size_m.y(), 0.0);
  const Point3 z(0.0, 0.0, size_m.z());
  const Point3 o = Point3::Zero();
  return {{o, x, y}, {z, x, y}, {o, x, z}, {y, x, z}, {o, y, z}, {x, y, z}};
}

std::vector<Rectangle> box_sides(const Point3& centre_below, double yaw_rad, const Point3& size_m) {
  const Point3 width = size_m.x() * Point3(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
  const Point3 depth = size_m.y() * Point3(-std::sin(yaw_rad), std::cos(yaw_rad), 0.0);
  const Point3 up(0.0, 0.0, size_m.z());
  const Point3 corner = centre_below - 0.5 * width - 0.5 * depth;
  return {{corner, width, up},
          {corner + depth, width, up},
          {corner, depth, up},
          {corner + width, depth, up},
          {corner + up, width, depth}};
}

Cloud moved(const Cloud& cloud, const Pose3& T) {
  Cloud result = cloud;
  for (CloudPoint& point : result) {
    const CloudPoint to = cloud_point(
        T * Point3(static_cast<double>(point.x_m), static_cast<double>(point.y_m), static_cast<double>(point.z_m)));
    point.x_m = to.x_m;
    point.y_m = to.y_m;
    point.z_m = to.z_m;
  }
  return result;
}

Cloud scan(const StandingScanner& scanner, const std::vector<Rectangle>& scene, Random& random) {
  Cloud cloud;
  for (int row = 0; row < scanner.scans; ++row) {
    const double elevation = scanner.first_elevation_rad + row * scanner.elevation_step_rad;
    for (int beam = 0; beam < scanner.beams; ++beam) {
      const double bearing = scanner.first_bearing_rad + beam * scanner.bearing_step_rad;
      const Point3 direction(std::cos(bearing) * std::cos(elevation), std::sin(bearing),
                             std::cos(bearing) * std::sin(elevation));
      std::optional<double> nearest;
      for (const Rectangle& rectangle : scene) {
        const std::optional<double> range_m = range_to(rectangle, scanner.at, direction);
        if (range_m && (!nearest || *range_m < *nearest)) nearest = range_m;
      }
      if (!nearest) continue;
      CloudPoint point = cloud_point(scanner.at + (*nearest + random.normal(0.0, scanner.noise_m)) * direction);
      point.elevation_rad = static_cast<float>(elevation);
      point.scan = static_cast<std::uint32_t>(row);
      cloud.push_back(point);
    }
  }
  return cloud;
}

}  // namespace gdtslam::test
