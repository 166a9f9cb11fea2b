// A room whose every surface is known, for the tests of cloud scenes: 8 by 5 by 2.5 m with a box in it, strewn evenly.
#pragma once

#include <vector>

#include "gdtslam/core/random.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"
#include "support/cloud_scenes.hpp"

namespace gdtslam::test {

inline const Point3 kRoomSize{8.0, 5.0, 2.5};

/// Floor and ceiling first; points carry stamps from 100 s on in the order in which they are, one each 1 ms.
inline Cloud room_cloud(std::size_t points_per_m2 = 900, double noise_m = 0.004) {
  Random random(11);
  Cloud cloud;
  std::vector<test::Rectangle> surfaces = test::room(kRoomSize);
  for (const test::Rectangle& side : test::box_sides({5.5, 3.0, 0.0}, 0.3, {1.2, 0.8, 0.9})) surfaces.push_back(side);
  for (const test::Rectangle& surface : surfaces) {
    const double area_m2 = surface.side.norm() * surface.other.norm();
    test::strew(cloud, surface, static_cast<std::size_t>(area_m2 * static_cast<double>(points_per_m2)), noise_m,
                random);
  }
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    cloud[k].stamp_s = 100.0 + 0.001 * static_cast<double>(k);
    cloud[k].scan = static_cast<std::uint32_t>(k / 500);
    cloud[k].elevation_rad = 0.1F * cloud[k].x_m - 0.3F;
  }
  return cloud;
}

/// A look whose picture depends on the least: no ceiling, no eye-dome lighting, one sample.
inline CloudLook plain_look(CloudColour colour = CloudColour::kHeight) {
  CloudLook look;
  look.colour = colour;
  look.with_ceiling = false;
  look.with_eye_dome = false;
  look.samples = 1;
  return look;
}

inline bool is_colour(const std::uint8_t* pixel, Colour colour, int tolerance = 2) {
  return std::abs(pixel[0] - colour.red) <= tolerance && std::abs(pixel[1] - colour.green) <= tolerance &&
         std::abs(pixel[2] - colour.blue) <= tolerance;
}

/// Pixels that are not the background's.
inline std::size_t covered(const RgbaImage& image, Colour background) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < image.pixels.size(); k += 4) {
    if (!is_colour(image.pixels.data() + k, background)) ++count;
  }
  return count;
}

/// Along x at 0.03 m/s from (1, kPathY), seen over the walls from everywhere.
inline constexpr double kPathY = 3.6;
inline Trajectory room_path() {
  Trajectory path;
  for (int k = 0; k <= 100; ++k) {
    path.push_back({.stamp_s = 100.0 + k, .T_map_base = {.x_m = 1.0 + 0.03 * k, .y_m = kPathY, .theta_rad = 0.0}});
  }
  return path;
}

}  // namespace gdtslam::test
