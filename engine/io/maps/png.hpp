// PNG files by libpng: 8-bit RGBA out, 16-bit grey out and in. Rows from the top, without padding. Thread-safe;
// O(pixels).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gdtslam {

struct Grey16Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint16_t> pixels;  ///< width * height, values of the host
};

/// The file's bytes. Throws Error for a side of 0 or beyond 2^31 - 1 pixels, for another number of pixels than that,
/// and where libpng has no memory.
std::string encode_png(const Grey16Image& image);
/// Of red, green, blue and alpha.
std::string encode_png(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba);

/// Grey of 16 bits (8-bit and colour images are refused). Throws InputError for what is damaged or has more than
/// `max_pixels` pixels, which is known before memory is taken.
Grey16Image decode_png_grey16(std::span<const std::byte> data, const std::string& name, std::uint64_t max_pixels);
Grey16Image read_png_grey16(const std::string& path, std::uint64_t max_pixels = std::uint64_t{1} << 29U);

}  // namespace gdtslam
