#include "png.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>

#include "engine/io/byte_source.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

// Not libpng's simplified interface, which needs no setjmp: it takes 16-bit grey for linear light, notes so in the file
// and converts what other programs noted, and these are distances.

enum class Direction : std::uint8_t { kRead, kWrite };

/// What libpng keeps of a file that is read or written, and the message of its error.
struct Codec {
  explicit Codec(Direction which)
      : direction(which),
        png(which == Direction::kRead ? png_create_read_struct(PNG_LIBPNG_VER_STRING, message, on_error, on_warning)
                                      : png_create_write_struct(PNG_LIBPNG_VER_STRING, message, on_error, on_warning)),
        info(png_create_info_struct(png)) {}
  Codec(const Codec&) = delete;
  Codec& operator=(const Codec&) = delete;
  ~Codec() {
    if (direction == Direction::kRead) {
      png_destroy_read_struct(&png, &info, nullptr);
    } else {
      png_destroy_write_struct(&png, &info);
    }
  }

  /// Makes calls of libpng; false where one fails. libpng then jumps back here, which must not pass over C++ objects:
  /// `calls` has none of its own.
  template <class Calls>
  bool run(const Calls& calls) {
    if (setjmp(png_jmpbuf(png)) != 0) {  // NOLINT(cert-err52-cpp): libpng's only way
      return false;
    }
    calls();
    return true;
  }

  static constexpr std::size_t kMessageBytes = 128;
  static void on_error(png_structp png, png_const_charp text) {
    std::strncpy(static_cast<char*>(png_get_error_ptr(png)), text, kMessageBytes - 1);
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp /*png*/, png_const_charp /*message*/) {}  // what is only odd is still readable

  char message[kMessageBytes] = {};
  Direction direction;
  png_structp png;
  png_infop info;
};

void append_bytes(png_structp png, png_bytep data, std::size_t size) {
  auto* const out = static_cast<std::string*>(png_get_io_ptr(png));
  bool has_room = true;
  try {
    out->append(reinterpret_cast<const char*>(data), size);
  } catch (const std::bad_alloc&) {
    has_room = false;
  }
  if (!has_room) {
    png_error(png, "out of memory");
  }
}
void flush_nothing(png_structp /*png*/) {}

std::string encode(std::uint32_t width, std::uint32_t height, int colour_type, std::span<const std::byte> pixels) {
  const bool is_grey16 = colour_type == PNG_COLOR_TYPE_GRAY;
  const std::size_t row_bytes = std::size_t{is_grey16 ? 2U : 4U} * width;
  Codec codec(Direction::kWrite);
  if (codec.info == nullptr || width == 0 || height == 0 || pixels.size() != row_bytes * height) {
    throw Error(ExitCode::kFailed, fmt::format("an image of {} x {} pixels in {} bytes cannot be made a PNG", width,
                                               height, pixels.size()));
  }
  std::string out;
  const bool is_done = codec.run([&] {
    png_set_write_fn(codec.png, &out, append_bytes, flush_nothing);
    png_set_user_limits(codec.png, 0x7fffffffU, 0x7fffffffU);
    png_set_IHDR(codec.png, codec.info, width, height, is_grey16 ? 16 : 8, colour_type, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(codec.png, codec.info);
    if (is_grey16 && std::endian::native == std::endian::little) png_set_swap(codec.png);
    for (std::uint32_t y = 0; y < height; ++y) {
      png_write_row(codec.png, reinterpret_cast<png_const_bytep>(pixels.data() + y * row_bytes));
    }
    png_write_end(codec.png, codec.info);
  });
  if (!is_done) {
    throw Error(ExitCode::kFailed, fmt::format("libpng cannot encode an image of {} x {} pixels: {}", width, height,
                                               static_cast<const char*>(codec.message)));
  }
  return out;
}

struct Input {
  const std::byte* data = nullptr;
  std::size_t left = 0;
};

void take_bytes(png_structp png, png_bytep target, std::size_t size) {
  auto* const input = static_cast<Input*>(png_get_io_ptr(png));
  if (size > input->left) {
    png_error(png, "the file stops early");
  }
  std::memcpy(target, input->data, size);
  input->data += size;
  input->left -= size;
}

struct Header {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  int depth = 0;
  int colour = 0;
  int interlace = 0;
};

bool read_header(Codec& codec, Input& input, Header& header) {
  return codec.run([&] {
    png_set_read_fn(codec.png, &input, take_bytes);
    png_set_user_limits(codec.png, 0x7fffffffU, 0x7fffffffU);
    png_set_chunk_malloc_max(codec.png, png_alloc_size_t{1} << 20U);
    png_set_chunk_cache_max(codec.png, 16);
    png_read_info(codec.png, codec.info);
    png_get_IHDR(codec.png, codec.info, &header.width, &header.height, &header.depth, &header.colour, &header.interlace,
                 nullptr, nullptr);
  });
}

/// Memory grows with the rows that are really there.
bool read_rows(Codec& codec, Grey16Image& image) {
  return codec.run([&] {
    if (std::endian::native == std::endian::little) png_set_swap(codec.png);
    png_read_update_info(codec.png, codec.info);
    for (std::uint32_t y = 0; y < image.height; ++y) {
      image.pixels.resize(image.pixels.size() + image.width);
      png_read_row(codec.png, reinterpret_cast<png_bytep>(&image.pixels[std::size_t{y} * image.width]), nullptr);
    }
    png_read_end(codec.png, nullptr);
  });
}

void check_header(const Header& header, std::size_t file_bytes, std::uint64_t max_pixels, const std::string& name) {
  constexpr std::uint64_t kLargestDeflateRatio = 1032;
  const std::uint64_t pixels = std::uint64_t{header.width} * header.height;
  if (header.colour != PNG_COLOR_TYPE_GRAY || header.depth != 16 || header.interlace != PNG_INTERLACE_NONE) {
    throw InputError({name, 0}, "is no 16-bit grey PNG without interlacing");
  }
  if (pixels > max_pixels) {
    throw InputError({name, 0}, fmt::format("has {} x {} pixels, more than the {} that are read", header.width,
                                            header.height, max_pixels));
  }
  if (pixels * 2 > file_bytes * kLargestDeflateRatio) {
    throw InputError({name, 0}, fmt::format("states {} x {} pixels, which {} bytes cannot hold", header.width,
                                            header.height, file_bytes));
  }
}

}  // namespace

std::string encode_png(const Grey16Image& image) {
  return encode(image.width, image.height, PNG_COLOR_TYPE_GRAY, std::as_bytes(std::span(image.pixels)));
}

std::string encode_png(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
  return encode(width, height, PNG_COLOR_TYPE_RGBA, std::as_bytes(rgba));
}

Grey16Image decode_png_grey16(std::span<const std::byte> data, const std::string& name, std::uint64_t max_pixels) {
  Codec codec(Direction::kRead);
  if (codec.info == nullptr) {
    throw Error(ExitCode::kFailed, located({name, 0}, "libpng cannot be started"));
  }
  Input input{data.data(), data.size()};
  Header header;
  if (!read_header(codec, input, header)) {
    throw InputError({name, 0}, fmt::format("is no readable PNG: {}", static_cast<const char*>(codec.message)));
  }
  check_header(header, data.size(), max_pixels, name);
  Grey16Image image{header.width, header.height, {}};
  if (!read_rows(codec, image)) {
    throw InputError({name, 0}, fmt::format("is a damaged PNG: {}", static_cast<const char*>(codec.message)));
  }
  return image;
}

Grey16Image read_png_grey16(const std::string& path, std::uint64_t max_pixels) {
  constexpr std::size_t kMaxFileBytes = std::size_t{1} << 31U;
  const std::unique_ptr<ByteSource> source = open_file_source(path);
  const std::string text = read_all(*source, kMaxFileBytes, path);
  return decode_png_grey16(std::as_bytes(std::span(text.data(), text.size())), path, max_pixels);
}

}  // namespace gdtslam
