// PNG files by libpng: writes 8-bit RGBA and grey and 16-bit grey; reads 16-bit grey, and any PNG as 8-bit grey. Rows
// from the top, without padding. Thread-safe; O(pixels).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

/// A grey picture, rows from the top.
struct Grey8Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t max_value = 255;  ///< the level that means white
  std::vector<std::uint8_t> pixels;
};

/// PGM (P5, one byte a pixel). The stated size must be that of the file, so that no memory is allocated by a wrong
/// header. Throws InputError.
Grey8Image decode_pgm(std::span<const std::byte> data, const std::string& name);

struct Grey16Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint16_t> pixels;  ///< width * height, values of the host
};

/// Writes a file row by row from the top; keeps only the compressor's memory.
class PngWriter {
 public:
  enum class Pixels : std::uint8_t { kGrey16, kRgba8, kGrey8 };
  /// Receives the bytes of the file; the writer passes its exceptions on.
  using Sink = std::function<void(std::span<const std::byte>)>;

  /// Fields of distances are filtered by the row above and packed by their runs; pictures are packed without a filter.
  /// Both take a fifth of the time of libpng's defaults at about the same size. All members throw Error like
  /// encode_png().
  PngWriter(std::uint32_t width, std::uint32_t height, Pixels pixels, Sink sink);
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter();

  /// The next row: 2, 4 or 1 bytes a pixel, values of the host.
  void add_row(std::span<const std::byte> row);
  /// After the last row; nothing may follow.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The file's bytes. Throws Error for a side of 0 or beyond 2^31 - 1 pixels, for a wrong number of pixels, and if
/// libpng has no memory.
std::string encode_png(const Grey16Image& image);
/// The same for red, green, blue and alpha.
std::string encode_png(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba);

/// Grey of 16 bits (8-bit and colour images are refused). Throws InputError for damaged data or more than `max_pixels`
/// pixels, which is checked before memory is allocated.
Grey16Image decode_png_grey16(std::span<const std::byte> data, const std::string& name, std::uint64_t max_pixels);
/// A file of at most 2^29 pixels. Also throws FileError.
Grey16Image read_png_grey16(const std::string& path);

inline constexpr std::string_view kPngMagic = "\x89PNG";
/// Any PNG without interlacing: the highest eight bits, the mean of colours, without transparency. Throws like
/// decode_png_grey16().
Grey8Image decode_png_grey8(std::span<const std::byte> data, const std::string& name, std::uint64_t max_pixels);

}  // namespace gdtslam
