// PNG files by libpng: 8-bit grey, RGB, RGBA and 16-bit grey out; 16-bit grey in. Thread-safe; O(pixels).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gdtslam {

enum class PixelFormat : std::uint8_t { kGrey8, kRgb8, kRgba8, kGrey16 };
[[nodiscard]] std::size_t bytes_per_pixel(PixelFormat format);

/// Rows from the top, without padding; 16-bit pixels in the host's byte order.
struct ImageView {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  PixelFormat format = PixelFormat::kGrey8;
  std::span<const std::byte> pixels;
};

/// The file's bytes. Throws Error when libpng refuses (a side of 0 or beyond 2^31 - 1 pixels).
std::string encode_png(const ImageView& image);
/// Atomic. Throws FileError too.
void write_png(const std::string& path, const ImageView& image);

struct Grey16Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint16_t> pixels;
};
/// Grey of 16 bits (8-bit and colour images are refused). Throws InputError for what is damaged or has more than
/// `max_pixels` pixels, which is known before memory is taken.
Grey16Image decode_png_grey16(std::span<const std::byte> data, const std::string& name, std::uint64_t max_pixels);
Grey16Image read_png_grey16(const std::string& path, std::uint64_t max_pixels = std::uint64_t{1} << 29U);

}  // namespace gdtslam
