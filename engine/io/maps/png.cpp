#include "png.hpp"

#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <string_view>
#include <utility>

#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
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
        png(which == Direction::kRead ? png_create_read_struct_2(PNG_LIBPNG_VER_STRING, message, on_error, on_warning,
                                                                 this, take_memory, give_back)
                                      : png_create_write_struct_2(PNG_LIBPNG_VER_STRING, message, on_error, on_warning,
                                                                  this, take_memory, give_back)),
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

  /// What libpng could not do for want of memory is no damage. Throws std::bad_alloc.
  void check_memory() const {
    if (is_out_of_memory) throw std::bad_alloc();
  }

  static png_voidp take_memory(png_structp png, png_alloc_size_t bytes) {
    void* const memory = std::malloc(bytes);
    if (memory == nullptr) static_cast<Codec*>(png_get_mem_ptr(png))->is_out_of_memory = true;
    return memory;
  }
  static void give_back(png_structp /*png*/, png_voidp memory) { std::free(memory); }

  static constexpr std::size_t kMessageBytes = 128;
  static void on_error(png_structp png, png_const_charp text) {
    std::strncpy(static_cast<char*>(png_get_error_ptr(png)), text, kMessageBytes - 1);
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp /*png*/, png_const_charp /*message*/) {}  // what is only odd is still readable

  char message[kMessageBytes] = {};
  bool is_out_of_memory = false;
  Direction direction;
  png_structp png;
  png_infop info;
};

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

// All kinds of pixels become one byte.
bool read_rows_as_grey8(Codec& codec, Grey8Image& image) {
  constexpr int kThird = 33333;  // of the weights of red and green, of 100,000
  return codec.run([&] {
    png_set_expand(codec.png);
    png_set_strip_16(codec.png);
    png_set_strip_alpha(codec.png);
    png_set_rgb_to_gray_fixed(codec.png, PNG_ERROR_ACTION_NONE, kThird, kThird);
    png_read_update_info(codec.png, codec.info);
    for (std::uint32_t y = 0; y < image.height; ++y) {
      image.pixels.resize(image.pixels.size() + image.width);
      png_read_row(codec.png, &image.pixels[std::size_t{y} * image.width], nullptr);
    }
    png_read_end(codec.png, nullptr);
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

// `bits` that a pixel takes in the file at least, and `kept` bytes that it takes in memory.
void check_size(const Header& header, std::uint64_t bits, std::uint64_t kept, std::size_t file_bytes,
                std::uint64_t max_pixels, const std::string& name) {
  constexpr std::uint64_t kLargestDeflateRatio = 1032;
  const std::uint64_t pixels = std::uint64_t{header.width} * header.height;
  if (pixels > max_pixels) {
    throw InputError({name, 0}, fmt::format("has {} x {} pixels, more than the {} that are read", header.width,
                                            header.height, max_pixels));
  }
  if (pixels / 8 * bits > file_bytes * kLargestDeflateRatio) {
    throw InputError({name, 0}, fmt::format("states {} x {} pixels, which {} bytes cannot hold", header.width,
                                            header.height, file_bytes));
  }
  check_kept_bytes(pixels * kept, file_bytes, name);
}

void check_header(const Header& header, std::size_t file_bytes, std::uint64_t max_pixels, const std::string& name) {
  if (header.colour != PNG_COLOR_TYPE_GRAY || header.depth != 16 || header.interlace != PNG_INTERLACE_NONE) {
    throw InputError({name, 0}, "is no 16-bit grey PNG without interlacing");
  }
  check_size(header, 16, sizeof(std::uint16_t), file_bytes, max_pixels, name);
}

// What decode_png() begins with.
Header header_of(Codec& codec, Input& input, const std::string& name) {
  if (codec.info == nullptr) throw Error(ExitCode::kFailed, located({name, 0}, "libpng cannot be started"));
  Header header;
  if (!read_header(codec, input, header)) {
    codec.check_memory();
    throw InputError({name, 0}, fmt::format("is no readable PNG: {}", static_cast<const char*>(codec.message)));
  }
  return header;
}

[[noreturn]] void fail_as_damaged(const Codec& codec, const std::string& name) {
  codec.check_memory();
  throw InputError({name, 0}, fmt::format("is a damaged PNG: {}", static_cast<const char*>(codec.message)));
}

std::size_t bytes_of_pixel(PngWriter::Pixels pixels) {
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

std::string bytes_of_file(const std::string& path) {
  constexpr std::size_t kMaxFileBytes = std::size_t{1} << 31U;
  const std::unique_ptr<ByteSource> source = open_file_source(path);
  return read_all(*source, kMaxFileBytes, path);
}

void flush_nothing(png_structp /*png*/) {}

// The best of filters none, sub, up, average and Paeth with levels 1 to 6 and runs only, measured on fields and maps of
// the public logs.
void set_packing(png_structp png, PngWriter::Pixels pixels) {
  const bool is_field = pixels == PngWriter::Pixels::kGrey16;  // else a picture, or what is known of cells
  png_set_filter(png, PNG_FILTER_TYPE_BASE, is_field ? PNG_FILTER_UP : PNG_FILTER_NONE);
  png_set_compression_level(png, is_field ? 1 : 3);
  if (is_field) png_set_compression_strategy(png, Z_RLE);
}

std::string encode(std::uint32_t width, std::uint32_t height, PngWriter::Pixels pixels,
                   std::span<const std::byte> bytes) {
  const std::size_t row_bytes = bytes_of_pixel(pixels) * width;
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
  State(std::uint32_t columns, std::uint32_t lines, Sink taker)
      : codec(Direction::kWrite), width(columns), height(lines), sink(std::move(taker)) {}

  /// Exceptions must not pass through libpng: they wait here while it jumps back.
  static void take(png_structp png, png_bytep data, std::size_t size) {
    auto* const state = static_cast<State*>(png_get_io_ptr(png));
    try {
      state->sink({reinterpret_cast<const std::byte*>(data), size});
    } catch (...) {
      state->problem = std::current_exception();
    }
    if (state->problem) png_error(png, "the bytes cannot be kept");
  }
  template <class Calls>
  void run(const Calls& calls) {
    if (codec.info != nullptr && codec.run(calls)) return;
    if (problem) std::rethrow_exception(problem);
    codec.check_memory();
    throw Error(ExitCode::kFailed, fmt::format("libpng cannot encode an image of {} x {} pixels: {}", width, height,
                                               static_cast<const char*>(codec.message)));
  }

  Codec codec;
  std::uint32_t width;
  std::uint32_t height;
  Sink sink;
  std::exception_ptr problem;
};

PngWriter::PngWriter(std::uint32_t width, std::uint32_t height, Pixels pixels, Sink sink)
    : state_(std::make_unique<State>(width, height, std::move(sink))) {
  State& state = *state_;
  const bool is_grey16 = pixels == Pixels::kGrey16;
  state.run([&] {
    png_structp png = state.codec.png;
    png_set_write_fn(png, &state, State::take, flush_nothing);
    png_set_user_limits(png, 0x7fffffffU, 0x7fffffffU);
    png_set_IHDR(png, state.codec.info, width, height, is_grey16 ? 16 : 8,
                 pixels == Pixels::kRgba8 ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    set_packing(png, pixels);
    png_write_info(png, state.codec.info);
    if (is_grey16 && std::endian::native == std::endian::little) png_set_swap(png);
  });
}

PngWriter::~PngWriter() = default;

void PngWriter::add_row(std::span<const std::byte> row) {
  state_->run([&] { png_write_row(state_->codec.png, reinterpret_cast<png_const_bytep>(row.data())); });
}

void PngWriter::finish() {
  state_->run([&] { png_write_end(state_->codec.png, state_->codec.info); });
}

std::string encode_png(const Grey16Image& image) {
  return encode(image.width, image.height, PngWriter::Pixels::kGrey16, std::as_bytes(std::span(image.pixels)));
}

std::string encode_png(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
  return encode(width, height, PngWriter::Pixels::kRgba8, std::as_bytes(rgba));
}

Grey16Image decode_png_grey16(std::span<const std::byte> data, const std::string& name, std::uint64_t max_pixels) {
  Codec codec(Direction::kRead);
  Input input{data.data(), data.size()};
  const Header header = header_of(codec, input, name);
  check_header(header, data.size(), max_pixels, name);
  Grey16Image image{header.width, header.height, {}};
  if (!read_rows(codec, image)) fail_as_damaged(codec, name);
  return image;
}

Grey16Image read_png_grey16(const std::string& path, std::uint64_t max_pixels) {
  const std::string text = bytes_of_file(path);
  return decode_png_grey16(std::as_bytes(std::span(text.data(), text.size())), path, max_pixels);
}

bool is_png(const std::string& path) {
  constexpr std::string_view kSignature = "\x89PNG";
  std::string head(kSignature.size(), '\0');
  return std::ifstream(path, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size())) &&
         head == kSignature;
}

Grey8Image decode_png_grey8(std::span<const std::byte> data, const std::string& name, std::uint64_t max_pixels) {
  Codec codec(Direction::kRead);
  Input input{data.data(), data.size()};
  const Header header = header_of(codec, input, name);
  if (header.interlace != PNG_INTERLACE_NONE) {
    throw InputError({name, 0}, "is an interlaced PNG; save it without interlacing");
  }
  check_size(header, 1, 1, data.size(), max_pixels, name);
  Grey8Image image{header.width, header.height, 255, {}};
  if (!read_rows_as_grey8(codec, image)) fail_as_damaged(codec, name);
  return image;
}

Grey8Image read_png_grey8(const std::string& path, std::uint64_t max_pixels) {
  const std::string text = bytes_of_file(path);
  return decode_png_grey8(std::as_bytes(std::span(text.data(), text.size())), path, max_pixels);
}

}  // namespace gdtslam
