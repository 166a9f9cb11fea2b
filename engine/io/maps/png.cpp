#include "png.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>

#include "engine/io/atomic_file.hpp"
#include "engine/io/byte_source.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

// libpng reports errors by longjmp, which must not pass over C++ objects: the functions that call setjmp hold none.

/// Where libpng's message goes; of trivial type for the jump.
struct ErrorText {
  char text[128] = {};
};

void on_error(png_structp png, png_const_charp message) {
  auto* const error = static_cast<ErrorText*>(png_get_error_ptr(png));
  std::strncpy(error->text, message, sizeof(error->text) - 1);
  png_longjmp(png, 1);
}
void on_warning(png_structp /*png*/, png_const_charp /*message*/) {}  // what is only odd is still readable

struct Writer {
  explicit Writer(ErrorText& error)
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, &error, on_error, on_warning)),
        info(png != nullptr ? png_create_info_struct(png) : nullptr) {}
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { png_destroy_write_struct(&png, &info); }
  png_structp png;
  png_infop info;
};

struct Reader {
  explicit Reader(ErrorText& error)
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &error, on_error, on_warning)),
        info(png != nullptr ? png_create_info_struct(png) : nullptr) {}
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
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

int colour_type(PixelFormat format) {
  switch (format) {
    case PixelFormat::kRgb8:
      return PNG_COLOR_TYPE_RGB;
    case PixelFormat::kRgba8:
      return PNG_COLOR_TYPE_RGBA;
    case PixelFormat::kGrey8:
    case PixelFormat::kGrey16:
      break;
  }
  return PNG_COLOR_TYPE_GRAY;
}

bool write_image(const Writer& writer, const ImageView& image, std::string* out, png_const_bytep first_row) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) {  // NOLINT(cert-err52-cpp): libpng's only way
    return false;
  }
  png_set_write_fn(writer.png, out, append_bytes, flush_nothing);
  png_set_user_limits(writer.png, 0x7fffffffU, 0x7fffffffU);
  const int depth = image.format == PixelFormat::kGrey16 ? 16 : 8;
  png_set_IHDR(writer.png, writer.info, image.width, image.height, depth, colour_type(image.format), PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(writer.png, writer.info);
  if (depth == 16 && std::endian::native == std::endian::little) {
    png_set_swap(writer.png);
  }
  const std::size_t row_bytes = image.width * bytes_per_pixel(image.format);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    png_write_row(writer.png, first_row + y * row_bytes);
  }
  png_write_end(writer.png, writer.info);
  return true;
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

bool read_header(const Reader& reader, Input* input, Header* header) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) {  // NOLINT(cert-err52-cpp)
    return false;
  }
  png_set_read_fn(reader.png, input, take_bytes);
  png_set_user_limits(reader.png, 0x7fffffffU, 0x7fffffffU);
  png_set_chunk_malloc_max(reader.png, png_alloc_size_t{1} << 20U);
  png_set_chunk_cache_max(reader.png, 16);
  png_read_info(reader.png, reader.info);
  png_get_IHDR(reader.png, reader.info, &header->width, &header->height, &header->depth, &header->colour,
               &header->interlace, nullptr, nullptr);
  return true;
}

bool begin_rows(const Reader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) {  // NOLINT(cert-err52-cpp)
    return false;
  }
  if (std::endian::native == std::endian::little) {
    png_set_swap(reader.png);
  }
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool read_row(const Reader& reader, std::uint16_t* pixels) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) {  // NOLINT(cert-err52-cpp)
    return false;
  }
  png_read_row(reader.png, reinterpret_cast<png_bytep>(pixels), nullptr);
  return true;
}

bool finish_rows(const Reader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) {  // NOLINT(cert-err52-cpp)
    return false;
  }
  png_read_end(reader.png, nullptr);
  return true;
}

/// Memory grows with the rows that are really there.
bool read_rows(const Reader& reader, Grey16Image& image) {
  if (!begin_rows(reader)) {
    return false;
  }
  for (std::uint32_t y = 0; y < image.height; ++y) {
    const std::size_t row = image.pixels.size();
    image.pixels.resize(row + image.width);
    if (!read_row(reader, image.pixels.data() + row)) {
      return false;
    }
  }
  return finish_rows(reader);
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

std::size_t bytes_per_pixel(PixelFormat format) {
  constexpr std::size_t kBytes[] = {1, 3, 4, 2};
  return kBytes[static_cast<std::size_t>(format)];
}

std::string encode_png(const ImageView& image) {
  std::string out;
  ErrorText error;
  const Writer writer(error);
  if (writer.info == nullptr || image.width == 0 || image.height == 0 ||
      image.pixels.size() != bytes_per_pixel(image.format) * image.width * image.height) {
    throw Error(ExitCode::kFailed, fmt::format("an image of {} x {} pixels in {} bytes cannot be made a PNG",
                                               image.width, image.height, image.pixels.size()));
  }
  if (!write_image(writer, image, &out, reinterpret_cast<png_const_bytep>(image.pixels.data()))) {
    throw Error(ExitCode::kFailed, fmt::format("libpng cannot encode an image of {} x {} pixels: {}", image.width,
                                               image.height, static_cast<const char*>(error.text)));
  }
  return out;
}

void write_png(const std::string& path, const ImageView& image) { write_file_atomically(path, encode_png(image)); }

Grey16Image decode_png_grey16(std::span<const std::byte> data, const std::string& name, std::uint64_t max_pixels) {
  ErrorText error;
  const Reader reader(error);
  if (reader.info == nullptr) {
    throw Error(ExitCode::kFailed, located({name, 0}, "libpng cannot be started"));
  }
  Input input{data.data(), data.size()};
  Header header;
  if (!read_header(reader, &input, &header)) {
    throw InputError({name, 0}, fmt::format("is no readable PNG: {}", static_cast<const char*>(error.text)));
  }
  check_header(header, data.size(), max_pixels, name);
  Grey16Image image{header.width, header.height, {}};
  if (!read_rows(reader, image)) {
    throw InputError({name, 0}, fmt::format("is a damaged PNG: {}", static_cast<const char*>(error.text)));
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
