// For the tests of drawn linkages: where caps are found in a picture.
#pragma once

#include <cmath>
#include <optional>

#include "gdtslam/core/pose3.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam::test {

/// Middle of the white cap whose ring surrounds the place; nothing where less than half of a disc of that radius is
/// white.
inline std::optional<Point2> cap_near(const RgbaImage& image, const Point2& at, double radius_px) {
  Point2 sum = Point2::Zero();
  int count = 0;
  const int reach = static_cast<int>(std::ceil(radius_px)) + 2;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const Point2 place(std::floor(at.x()) + x, std::floor(at.y()) + y);
      if (place.x() < 0 || place.y() < 0 || place.x() >= image.width || place.y() >= image.height) continue;
      const std::uint8_t* pixel =
          image.at(static_cast<std::uint32_t>(place.x()), static_cast<std::uint32_t>(place.y()));
      if (pixel[0] < 235 || pixel[1] < 235 || pixel[2] < 230) continue;
      sum += place + Point2(0.5, 0.5);
      ++count;
    }
  }
  if (count < 0.5 * 3.14 * radius_px * radius_px) return std::nullopt;
  return Point2(sum / count);
}

}  // namespace gdtslam::test
