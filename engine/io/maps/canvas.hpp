// Anti-aliased drawing into an RGB image: pixel (x, y) covers the square [x, x+1) x [y, y+1), y down. A layer collects
// coverage by maximum, so that the joints of a line do not show, and is then blended once.
#pragma once

#include <cstdint>
#include <vector>

#include "overview.hpp"

namespace gdtslam {

struct PixelColour {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
};
/// Between two colours, share 0 to 1 of the second.
PixelColour mix(PixelColour a, PixelColour b, double share);

struct Pixel2 {
  double x = 0.0;
  double y = 0.0;
};

/// Pixels that are drawn, in rows or columns.
struct PixelRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

class Layer {
 public:
  Layer(std::uint32_t width, std::uint32_t height);
  /// From now on only pixels whose square lies in the rectangle are drawn.
  void clip(Pixel2 min, Pixel2 max);
  /// A line with round ends; a == b gives a disc.
  void stroke(Pixel2 a, Pixel2 b, double radius, PixelColour colour);
  void disc(Pixel2 centre, double radius, PixelColour colour) { stroke(centre, centre, radius, colour); }
  /// Axis-parallel, between two opposite corners.
  void rectangle(Pixel2 min, Pixel2 max, PixelColour colour);
  /// Lays the layer over the image.
  void blend_onto(RgbImage& image, double opacity = 1.0) const;

 private:
  [[nodiscard]] PixelRange rows(double low, double high) const;
  [[nodiscard]] PixelRange columns(double low, double high) const;
  void cover(std::size_t pixel, double coverage, PixelColour colour);
  std::uint32_t width_;
  Pixel2 clip_min_{};
  Pixel2 clip_max_;
  std::vector<std::uint8_t> coverage_;
  std::vector<PixelColour> colours_;
};

}  // namespace gdtslam
