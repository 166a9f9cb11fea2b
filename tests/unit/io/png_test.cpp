// PNG files, checked with libpng's other interface, and the files of the distance field.
#include "gdtslam/io/png.hpp"

#include <gmock/gmock.h>
#include <png.h>

#include <cstring>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/distance_field_file.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

/// Decodes 8-bit files with libpng's simplified interface.
std::vector<std::uint8_t> decode_8_bit(const std::string& file, png_uint_32 format, png_image& image) {
  image = {};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&image, file.data(), file.size()), 0);
  image.format = format;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
  return pixels;
}

template <class T>
std::string encoded(std::uint32_t width, std::uint32_t height, PixelFormat format, const std::vector<T>& pixels) {
  return encode_png({width, height, format, std::as_bytes(std::span(pixels))});
}

TEST(Png, OtherDecodersReadTheSamePixels) {
  struct Case {
    PixelFormat format;
    png_uint_32 libpng_format;
    std::size_t bytes;
  };
  for (const Case& c : {Case{PixelFormat::kGrey8, PNG_FORMAT_GRAY, 1}, Case{PixelFormat::kRgb8, PNG_FORMAT_RGB, 3},
                        Case{PixelFormat::kRgba8, PNG_FORMAT_RGBA, 4}}) {
    std::vector<std::uint8_t> pixels;
    for (std::size_t i = 0; i < 7 * 5 * c.bytes; ++i) {
      pixels.push_back(static_cast<std::uint8_t>(i * 37));
    }
    png_image image;
    EXPECT_EQ(decode_8_bit(encoded(7, 5, c.format, pixels), c.libpng_format, image), pixels);
    EXPECT_EQ(image.width, 7U);
    EXPECT_EQ(image.height, 5U);
  }
}

TEST(Png, SixteenBitsStandInTheFileWithTheHighByteFirst) {
  // The only pixel has no neighbours, so whatever the row's filter, its bytes are the pixel's own.
  const std::string file = encoded<std::uint16_t>(1, 1, PixelFormat::kGrey16, {0x1234});
  const std::size_t chunk = file.find("IDAT") + 4;
  std::array<Bytef, 16> row{};
  uLongf size = row.size();
  ASSERT_EQ(uncompress(row.data(), &size, reinterpret_cast<const Bytef*>(file.data() + chunk),
                       static_cast<uLong>(file.size() - chunk)),
            Z_OK);
  ASSERT_EQ(size, 3U);
  EXPECT_EQ(row[1], 0x12);
  EXPECT_EQ(row[2], 0x34);
}

TEST(Png, SixteenBitsReadBack) {
  const std::vector<std::uint16_t> pixels = {0x1234, 0xfedc, 0, 65535, 256, 255};
  const std::string file = encoded(3, 2, PixelFormat::kGrey16, pixels);
  EXPECT_THAT(decode_png_grey16(bytes_of(file), "t.png", 100).pixels, ElementsAreArray(pixels));
}

TEST(Png, RefusesImagesThatCannotBe) {
  EXPECT_THROW(encoded<std::uint8_t>(0, 1, PixelFormat::kGrey8, {}), Error);
  EXPECT_THROW(encoded<std::uint8_t>(2, 2, PixelFormat::kGrey8, {1, 2, 3}), Error);
}

TEST(Png, DamagedFilesAreInputErrors) {
  std::vector<std::uint16_t> pixels(64 * 64);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = static_cast<std::uint16_t>(i * 40503U);
  }
  const std::string file = encoded(64, 64, PixelFormat::kGrey16, pixels);
  for (std::size_t size = 0; size < file.size(); size += size < 60 ? 1 : 97) {
    EXPECT_THROW(decode_png_grey16(bytes_of(file.substr(0, size)), "t.png", 1 << 20), InputError) << size;
  }
  for (std::size_t i = 0; i < file.size(); i += i < 60 ? 1 : 97) {
    std::string damaged = file;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x41);
    EXPECT_THROW(decode_png_grey16(bytes_of(damaged), "t.png", 1 << 20), InputError) << i;
  }
}

TEST(Png, SizeIsBoundedBeforeMemoryIsTaken) {
  std::string file = encoded<std::uint16_t>(4, 4, PixelFormat::kGrey16, std::vector<std::uint16_t>(16));
  EXPECT_THROW(decode_png_grey16(bytes_of(file), "t.png", 15), InputError);
  const std::array<unsigned char, 8> huge = {0x00, 0x0f, 0xff, 0xff, 0x00, 0x0f, 0xff, 0xff};
  std::memcpy(file.data() + 16, huge.data(), huge.size());
  const auto crc = static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(file.data() + 12), 17));
  for (std::size_t i = 0; i < 4; ++i) {
    file[29 + i] = static_cast<char>(crc >> (24 - 8 * i));
  }
  const BoundedRun run = run_alone([&] {
    try {
      decode_png_grey16(bytes_of(file), "t.png", std::uint64_t{1} << 62U);
    } catch (const InputError& error) {
      return std::string(error.what()).find("cannot hold") != std::string::npos ? 0 : 1;
    }
    return 2;
  });
  EXPECT_EQ(run.code, 0);
  expect_bounded(run);
}

TEST(Png, OtherKindsAreRefused) {
  const std::string file = encoded<std::uint8_t>(1, 1, PixelFormat::kGrey8, {7});
  EXPECT_THROW(decode_png_grey16(bytes_of(file), "t.png", 100), InputError);
}

TEST(DistanceFieldFile, WritesEveryBitWithItsDescription) {
  const TemporaryFolder folder;
  // Three cells a row, stored with a stride of five.
  const std::vector<std::uint16_t> cells = {1, 2, 3, 99, 99, 40000, 5, 6, 99, 99};
  write_distance_field(folder / "gdt.yaml", {{0.05, -1.5, 2.25, 3, 2}, 5, cells, 5120});
  EXPECT_EQ(get_file(folder / "gdt.yaml"),
            "version: 1\nimage: gdt.png\nresolution: 0.05  # m per pixel\norigin: [-1.5, 2.25, 0.0]  # m, lower left "
            "corner\nunit: 0.0001953125  # m per grey level, 1/256 cell\ncap: 5120  # level that means this far or "
            "farther, or unknown\n");
  // The picture's first row is the one of the highest y.
  EXPECT_THAT(read_png_grey16(folder / "gdt.png").pixels, ElementsAre(40000, 5, 6, 1, 2, 3));
  const DistanceFieldFile field = read_distance_field(folder / "gdt.yaml");
  EXPECT_EQ(field.geometry, (GridGeometry{0.05, -1.5, 2.25, 3, 2}));
  EXPECT_THAT(field.cells, ElementsAre(1, 2, 3, 40000, 5, 6));
  EXPECT_EQ(field.cap, 5120);
}

TEST(DistanceFieldFile, OtherVersionsAndCapsAreRefused) {
  const TemporaryFolder folder;
  const std::vector<std::uint16_t> cells = {1};
  write_distance_field(folder / "gdt.yaml", {{0.05, 0, 0, 1, 1}, 1, cells, 5});
  const std::string text = get_file(folder / "gdt.yaml");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    put_file(folder / "gdt.yaml", changed.replace(changed.find(from), from.size(), to));
    try {
      read_distance_field(folder / "gdt.yaml");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(with("version: 1", "version: 2"), HasSubstr("gdt.yaml:1: version: only version 1 is read"));
  EXPECT_THAT(with("cap: 5", "cap: 65536"), HasSubstr("cap"));
  EXPECT_THAT(with("cap: 5", "cap: 1.5"), HasSubstr("cap"));
  EXPECT_THAT(with("image: gdt.png", "image: ../gdt.png"), HasSubstr("leads out"));
}

}  // namespace
}  // namespace gdtslam
