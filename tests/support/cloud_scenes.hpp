// Clouds whose truth is known, made with the plainest geometry: points strewn on rectangles, and a standing scanner
// that casts its beams at rectangles one by one.
#pragma once

#include <optional>
#include <vector>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::test {

/// corner + a * side + b * other for a and b in [0, 1]; the sides are at right angles.
struct Rectangle {
  Point3 corner;
  Point3 side;
  Point3 other;
  [[nodiscard]] Point3 normal() const { return side.cross(other).normalized(); }
};

CloudPoint cloud_point(const Point3& point);
/// Points evenly at random on the rectangle, off it by a normal error.
void strew(Cloud& cloud, const Rectangle& rectangle, std::size_t count, double noise_m, Random& random);
/// Points anywhere in a cube around a centre.
void strew_outliers(Cloud& cloud, const Point3& centre, double half_m, std::size_t count, Random& random);
/// Floor, ceiling and four walls, from (0, 0, 0) to the size.
std::vector<Rectangle> room(const Point3& size_m);
/// The walls of an upright box on z = 0 and its upper side. The first two are those along the width.
std::vector<Rectangle> box_sides(const Point3& centre_below, double yaw_rad, const Point3& size_m);
/// Every point moved by T.
Cloud moved(const Cloud& cloud, const Pose3& T);

/// A scanner that stands and nods: at each elevation a fan of bearings, as a scan plane tilted about the y axis has
/// them.
struct StandingScanner {
  Point3 at{0.0, 0.0, 0.3};
  double first_bearing_rad = -2.0;
  double bearing_step_rad = 0.00436;
  int beams = 920;
  double first_elevation_rad = 0.0;
  double elevation_step_rad = 0.004;
  int scans = 260;
  double noise_m = 0.01;
};
Cloud scan(const StandingScanner& scanner, const std::vector<Rectangle>& scene, Random& random);

}  // namespace gdtslam::test
