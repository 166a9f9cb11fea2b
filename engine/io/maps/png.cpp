#include "png.hpp"

#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <bit>
#include <cstring>
#include <new>
#include <utility>

#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

// Not libpng's simplified interface: it treats 16-bit grey as linear light, records that in the file and converts other
// programs' values, but these are distances.

// Exceptions pass through libpng, whose functions have unwind tables and keep all resources in its structures.
[[noreturn]] void fail_to_read(png_structp png, png_const_charp text) {
  throw InputError({*static_cast<const std::string*>(png_get_error_ptr(png)), 0},
                   fmt::format("is a damaged PNG: {}", text));
}
[[noreturn]] void fail_to_write(png_structp /*png*/, png_const_charp text) {
  throw Error(ExitCode::kFailed, fmt::format("libpng cannot encode an image: {}", text));
}
void ignore_warning(png_structp /*png*/, png_const_charp /*text*/) {}  // a picture that is only odd is readable

/// A PNG in memory: its header, then its rows from the top. Every member throws InputError for damaged data.
class PngReader {
 public:
  PngReader(std::span<const std::byte> data, const std::string& name) : data_(data), left_(data), name_(name) {
    if (info_ == nullptr) throw std::bad_alloc();
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  void read_header() {
    png_set_read_fn(png_, this, take_bytes);
    png_set_user_limits(png_, 0x7fffffffU, 0x7fffffffU);
    png_set_chunk_malloc_max(png_, png_alloc_size_t{1} << 20U);
    png_set_chunk_cache_max(png_, 16);
    png_read_info(png_, info_);
  }
  [[nodiscard]] std::uint32_t width() const { return png_get_image_width(png_, info_); }
  [[nodiscard]] std::uint32_t height() const { return png_get_image_height(png_, info_); }
  [[nodiscard]] bool is_interlaced() const { return png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE; }
  [[nodiscard]] bool is_grey16() const {
    return png_get_color_type(png_, info_) == PNG_COLOR_TYPE_GRAY && png_get_bit_depth(png_, info_) == 16;
  }

  /// `bits`: least size of a pixel in the file; `kept`: its bytes in memory.
  void check_size(std::uint64_t bits, std::uint64_t kept, std::uint64_t max_pixels) const {
    constexpr std::uint64_t kLargestDeflateRatio = 1032;
    const std::uint64_t pixels = std::uint64_t{width()} * height();
    if (pixels > max_pixels) {
      throw InputError(
          {name_, 0}, fmt::format("has {} x {} pixels, more than the {} that are read", width(), height(), max_pixels));
    }
    if (pixels / 8 * bits > data_.size() * kLargestDeflateRatio) {
      throw InputError({name_, 0}, fmt::format("states {} x {} pixels, which {} bytes cannot hold", width(), height(),
                                               data_.size()));
    }
    check_kept_bytes(pixels * kept, data_.size(), name_);
  }

  void set_host_order() {
    if (std::endian::native == std::endian::little) png_set_swap(png_);
  }
  /// Converts all kinds of pixels to one byte.
  void set_grey8() {
    constexpr int kThird = 33333;  // weight of red and of green, in 100,000ths
    png_set_expand(png_);
    png_set_strip_16(png_);
    png_set_strip_alpha(png_);
    png_set_rgb_to_gray_fixed(png_, PNG_ERROR_ACTION_NONE, kThird, kThird);
  }
  /// Memory grows only with rows that exist.
  template <class Pixel>
  std::vector<Pixel> read_rows() {
    std::vector<Pixel> pixels;
    png_read_update_info(png_, info_);
    for (std::uint32_t y = 0; y < height(); ++y) {
      pixels.resize(pixels.size() + width());
      png_read_row(png_, reinterpret_cast<png_bytep>(&pixels[std::size_t{y} * width()]), nullptr);
    }
    png_read_end(png_, nullptr);
    return pixels;
  }

 private:
  static void take_bytes(png_structp png, png_bytep target, std::size_t size) {
    auto& left = static_cast<PngReader*>(png_get_io_ptr(png))->left_;
    if (size > left.size()) png_error(png, "the file stops early");
    std::memcpy(target, left.data(), size);
    left = left.subspan(size);
  }

  std::span<const std::byte> data_;
  std::span<const std::byte> left_;
  std::string name_;
  png_structp png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &name_, fail_to_read, ignore_warning);
  png_infop info_ = png_create_info_struct(png_);
};

std::size_t pixel_bytes(PngWriter::Pixels pixels) {
  switch (pixels) {
    case PngWriter::Pixels::kGrey16:
      return 2;
    case PngWriter::Pixels::kRgba8:
      return 4;
    case PngWriter::Pixels::kGrey8:
      break;
  }
  return 1;
}

void flush_nothing(png_structp /*png*/) {}

// The best of filters none, sub, up, average and Paeth with levels 1 to 6 and runs only, measured on fields and maps of
// the public logs.
void set_packing(png_structp png, PngWriter::Pixels pixels) {
  const bool is_field = pixels == PngWriter::Pixels::kGrey16;  // else a picture, or the states of cells
  png_set_filter(png, PNG_FILTER_TYPE_BASE, is_field ? PNG_FILTER_UP : PNG_FILTER_NONE);
  png_set_compression_level(png, is_field ? 1 : 3);
  if (is_field) png_set_compression_strategy(png, Z_RLE);
}

std::string encode(std::uint32_t width, std::uint32_t height, PngWriter::Pixels pixels,
                   std::span<const std::byte> bytes) {
  const std::size_t row_bytes = pixel_bytes(pixels) * width;
  if (width == 0 || height == 0 || bytes.size() != row_bytes * height) {
    throw Error(ExitCode::kFailed, fmt::format("an image of {} x {} pixels in {} bytes cannot be made a PNG", width,
                                               height, bytes.size()));
  }
  std::string file;
  PngWriter writer(width, height, pixels, [&file](std::span<const std::byte> part) {
    file.append(reinterpret_cast<const char*>(part.data()), part.size());
  });
  for (std::size_t y = 0; y < height; ++y) writer.add_row(bytes.subspan(y * row_bytes, row_bytes));
  writer.finish();
  return file;
}

}  // namespace

struct PngWriter::State {
  explicit State(Sink taker) : sink(std::move(taker)) {
    if (info == nullptr) throw std::bad_alloc();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { png_destroy_write_struct(&png, &info); }
  static void take(png_structp png, png_bytep data, std::size_t size) {
    static_cast<State*>(png_get_io_ptr(png))->sink({reinterpret_cast<const std::byte*>(data), size});
  }

  Sink sink;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail_to_write, ignore_warning);
  png_infop info = png_create_info_struct(png);
};

PngWriter::PngWriter(std::uint32_t width, std::uint32_t height, Pixels pixels, Sink sink)
    : state_(std::make_unique<State>(std::move(sink))) {
  const bool is_grey16 = pixels == Pixels::kGrey16;
  png_structp png = state_->png;
  png_set_write_fn(png, state_.get(), State::take, flush_nothing);
  png_set_user_limits(png, 0x7fffffffU, 0x7fffffffU);
  png_set_IHDR(png, state_->info, width, height, is_grey16 ? 16 : 8,
               pixels == Pixels::kRgba8 ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  set_packing(png, pixels);
  png_write_info(png, state_->info);
  if (is_grey16 && std::endian::native == std::endian::little) png_set_swap(png);
}

PngWriter::~PngWriter() = default;

void PngWriter::add_row(std::span<const std::byte> row) {
  png_write_row(state_->png, reinterpret_cast<png_const_bytep>(row.data()));
}

void PngWriter::finish() { png_write_end(state_->png, state_->info); }

std::string encode_png(const Grey16Image& image) {
  return encode(image.width, image.height, PngWriter::Pixels::kGrey16, std::as_bytes(std::span(image.pixels)));
}

std::string encode_png(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
  return encode(width, height, PngWriter::Pixels::kRgba8, std::as_bytes(rgba));
}

Grey16Image decode_png_grey16(std::span<const std::byte> data, const std::string& name, std::uint64_t max_pixels) {
  PngReader png(data, name);
  png.read_header();
  if (!png.is_grey16() || png.is_interlaced()) {
    throw InputError({name, 0}, "is a PNG of another kind than 16-bit grey without interlacing");
  }
  png.check_size(16, sizeof(std::uint16_t), max_pixels);
  png.set_host_order();
  return {png.width(), png.height(), png.read_rows<std::uint16_t>()};
}

Grey16Image read_png_grey16(const std::string& path) {
  constexpr std::size_t kMaxFileBytes = std::size_t{1} << 31U;
  constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 29U;
  const std::string text = read_all(*open_file_source(path), kMaxFileBytes, path);
  return decode_png_grey16(std::as_bytes(std::span(text.data(), text.size())), path, kMaxPixels);
}

Grey8Image decode_png_grey8(std::span<const std::byte> data, const std::string& name, std::uint64_t max_pixels) {
  PngReader png(data, name);
  png.read_header();
  if (png.is_interlaced()) throw InputError({name, 0}, "is an interlaced PNG; save it without interlacing");
  png.check_size(1, 1, max_pixels);
  png.set_grey8();
  return {png.width(), png.height(), 255, png.read_rows<std::uint8_t>()};
}

}  // namespace gdtslam
