// Pictures in memory: 8-bit red, green, blue, alpha (not premultiplied), rows from the top, without padding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gdtslam {

/// Width and height of a picture, pixels.
struct PictureSize {
  std::uint32_t width = 1280;
  std::uint32_t height = 720;
  [[nodiscard]] double aspect() const { return static_cast<double>(width) / static_cast<double>(height); }
};

/// Pixels in rows from the top, four bytes each.
struct RgbaImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> pixels;  ///< 4 * width * height

  RgbaImage() = default;
  /// All pixels transparent black.
  RgbaImage(std::uint32_t width_px, std::uint32_t height_px)
      : width(width_px), height(height_px), pixels(std::size_t{4} * width_px * height_px) {}
  /// The four bytes of a pixel; x from the left, y from the top.
  [[nodiscard]] const std::uint8_t* at(std::uint32_t x, std::uint32_t y) const {
    return pixels.data() + std::size_t{4} * (std::size_t{y} * width + x);
  }
  [[nodiscard]] std::uint8_t* at(std::uint32_t x, std::uint32_t y) {
    return pixels.data() + std::size_t{4} * (std::size_t{y} * width + x);
  }
};

}  // namespace gdtslam
