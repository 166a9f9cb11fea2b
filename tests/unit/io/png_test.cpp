// PNG files, checked with libpng's other interface, and the files of the distance field.
#include "engine/io/maps/png.hpp"

#include <gmock/gmock.h>
#include <png.h>

#include <cstring>
#include <functional>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/io/map_files.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::ElementsAre;
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

/// A file by libpng's simplified interface.
std::string encode_8_bit(png_uint_32 format, std::uint32_t width, std::uint32_t height,
                         const std::vector<std::uint8_t>& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = format;
  png_alloc_size_t size = 0;
  EXPECT_NE(png_image_write_to_memory(&image, nullptr, &size, 0, pixels.data(), 0, nullptr), 0);
  std::string file(size, '\0');
  EXPECT_NE(png_image_write_to_memory(&image, file.data(), &size, 0, pixels.data(), 0, nullptr), 0);
  file.resize(size);
  return file;
}

TEST(Png, AnyPictureIsReadAsGrey) {
  const std::vector<std::uint8_t> grey = {0, 254, 205, 7};
  EXPECT_EQ(decode_png_grey8(bytes_of(encode_8_bit(PNG_FORMAT_GRAY, 2, 2, grey)), "t.png", 100).pixels, grey);
  // The mean of the colours; what is transparent counts as what is not.
  const std::vector<std::uint8_t> rgba = {30, 60, 90, 0, 255, 255, 255, 128, 0, 0, 0, 255, 205, 205, 205, 9};
  const Grey8Image image = decode_png_grey8(bytes_of(encode_png(2, 2, rgba)), "t.png", 100);
  EXPECT_THAT(image.pixels, ElementsAre(60, 255, 0, 205));
  EXPECT_EQ(image.max_value, 255U);
  EXPECT_THAT(decode_png_grey8(bytes_of(encode_png({2, 1, {0xff00, 0x1200}})), "t.png", 100).pixels,
              ElementsAre(0xff, 0x12));
  EXPECT_THROW(decode_png_grey8(bytes_of(encode_png(2, 2, rgba)), "t.png", 3), InputError);
  const std::string whole = encode_png(2, 2, rgba);
  for (std::size_t size = 0; size + 12 < whole.size(); ++size) {
    EXPECT_THROW(decode_png_grey8(bytes_of(whole.substr(0, size)), "t.png", 100), InputError) << size;
  }
}

TEST(Png, GreyIsWrittenAsOtherDecodersReadIt) {
  std::string file;
  PngWriter writer(3, 2, PngWriter::Pixels::kGrey8, [&file](std::span<const std::byte> part) {
    file.append(reinterpret_cast<const char*>(part.data()), part.size());
  });
  const std::vector<std::uint8_t> pixels = {0, 254, 205, 1, 2, 3};
  for (std::size_t row = 0; row < 2; ++row) writer.add_row(std::as_bytes(std::span(pixels).subspan(3 * row, 3)));
  writer.finish();
  png_image image;
  EXPECT_EQ(decode_8_bit(file, PNG_FORMAT_GRAY, image), pixels);
}

TEST(Png, SixteenBitsStandInTheFileWithTheHighByteFirst) {
  // The only pixel has no neighbours, so whatever the row's filter, its bytes are the pixel's own.
  const std::string file = encode_png({1, 1, {0x1234}});
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

TEST(Png, WhatTheTakerOfTheBytesThrowsComesOutOfTheWriter) {
  std::size_t taken = 0;
  const auto is_full = [&taken](std::span<const std::byte> bytes) {
    taken += bytes.size();
    if (taken > 20000) throw FileError("t.png", "no space left");
  };
  PngWriter writer(1000, 1000, PngWriter::Pixels::kRgba8, is_full);
  Random random(5);
  std::vector<std::uint8_t> row(4000);
  const auto write_rows = [&] {
    for (int y = 0; y < 1000; ++y) {
      for (std::uint8_t& value : row) value = static_cast<std::uint8_t>(random.bits());
      writer.add_row(std::as_bytes(std::span(row)));
    }
  };
  EXPECT_THROW(write_rows(), FileError);
  EXPECT_THROW(PngWriter(0, 1, PngWriter::Pixels::kRgba8, is_full), Error);
}

TEST(Png, DamagedFilesAreInputErrors) {
  std::vector<std::uint16_t> pixels(64 * 64);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = static_cast<std::uint16_t>(i * 40503U);
  }
  const std::string file = encode_png({64, 64, pixels});
  for (std::size_t size = 0; size < file.size(); size += size < 60 ? 1 : 97) {
    EXPECT_THROW(decode_png_grey16(bytes_of(file.substr(0, size)), "t.png", 1 << 20), InputError) << size;
  }
  for (const std::size_t missing : {std::size_t{1}, file.size() / 2}) {
    try {
      decode_png_grey16(bytes_of(file.substr(0, file.size() - missing)), "t.png", 1 << 20);
      FAIL() << "a cut file is read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("stops early"), std::string::npos) << error.what();
    }
  }
  for (std::size_t i = 0; i < file.size(); i += i < 60 ? 1 : 97) {
    std::string damaged = file;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x41);
    EXPECT_THROW(decode_png_grey16(bytes_of(damaged), "t.png", 1 << 20), InputError) << i;
  }
}

TEST(Png, SizeIsBoundedBeforeMemoryIsTaken) {
  std::string file = encode_png({4, 4, std::vector<std::uint16_t>(16)});
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

std::string input_error_of(const std::function<void()>& action) { return told_by<InputError>(action, "no error"); }

TEST(DistanceFieldFile, WritesEveryBitWithItsDescription) {
  const TemporaryFolder folder;
  // Three cells a row, stored with a stride of five; what lies in the padding is no part of the field.
  const std::vector<std::uint16_t> cells = {1, 2, 3, 9999, 9999, 5120, 5, 0, 9999, 9999};
  write_distance_field(folder / "gdt.yaml", rows_of(DistanceFieldView{{0.05, -1.5, 2.25, 3, 2}, 5, cells, 5120}));
  // By hand: floor(65535 / 5120) = 12, 5120 * 12 = 61440, 0.05 / 256 / 12 = 1.62760416...e-5.
  EXPECT_EQ(get_file(folder / "gdt.yaml"),
            "version: 2\nimage: gdt.png\nresolution: 0.05  # m per pixel\norigin: [-1.5, 2.25, 0.0]  # m, lower left "
            "corner\nunit: 1.6276041666666666e-05  # m per grey level, resolution/256/scale\nscale: 12  # grey levels "
            "per 1/256 cell\ncap: 61440  # level that means this far or farther, or unknown\n");
  // The picture's first row is the one of the highest y.
  EXPECT_THAT(read_png_grey16(folder / "gdt.png").pixels, ElementsAre(61440, 60, 0, 12, 24, 36));
  const DistanceFieldFile field = read_distance_field(folder / "gdt.yaml");
  EXPECT_EQ(field.geometry, (GridGeometry{0.05, -1.5, 2.25, 3, 2}));
  EXPECT_THAT(field.cells, ElementsAre(1, 2, 3, 5120, 5, 0));
  EXPECT_EQ(field.cap, 5120);
}

TEST(DistanceFieldFile, EveryValueUnderEveryKindOfCapReadsBack) {
  const TemporaryFolder folder;
  for (const int cap : {1, 2, 255, 5120, 21845, 32767, 32768, 65535}) {
    std::vector<std::uint16_t> cells;
    for (int value = 0; value <= cap; ++value) cells.push_back(static_cast<std::uint16_t>(value));
    const GridGeometry geometry{0.05, 0, 0, static_cast<std::int32_t>(cells.size()), 1};
    write_distance_field(folder / "gdt.yaml",
                         rows_of(DistanceFieldView{geometry, cells.size(), cells, static_cast<std::uint16_t>(cap)}));
    const DistanceFieldFile field = read_distance_field(folder / "gdt.yaml");
    EXPECT_EQ(field.cells, cells) << cap;
    EXPECT_EQ(field.cap, cap);
    // Bright enough to be seen: the farthest is in the upper half of the levels.
    EXPECT_GE(read_png_grey16(folder / "gdt.png").pixels.back(), 32767) << cap;
  }
}

TEST(DistanceFieldFile, VersionOneIsRead) {
  const TemporaryFolder folder;
  put_file(folder / "gdt.png", encode_png({2, 2, {7, 5120, 0, 1}}));
  put_file(folder / "gdt.yaml",
           "version: 1\nimage: gdt.png\nresolution: 0.05  # m per pixel\norigin: [-1.5, 2.25, 0.0]  # m, lower left "
           "corner\nunit: 0.0001953125  # m per grey level, 1/256 cell\ncap: 5120  # level that means this far or "
           "farther, or unknown\n");
  const DistanceFieldFile field = read_distance_field(folder / "gdt.yaml");
  EXPECT_THAT(field.cells, ElementsAre(0, 1, 7, 5120));
  EXPECT_EQ(field.cap, 5120);
}

TEST(DistanceFieldFile, WhatContradictsItselfIsRefused) {
  const TemporaryFolder folder;
  const std::vector<std::uint16_t> cells = {1};
  write_distance_field(folder / "gdt.yaml", rows_of(DistanceFieldView{{0.05, 0, 0, 1, 1}, 1, cells, 5120}));
  const std::string text = get_file(folder / "gdt.yaml");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    put_file(folder / "gdt.yaml", changed.replace(changed.find(from), from.size(), to));
    return input_error_of([&] { read_distance_field(folder / "gdt.yaml"); });
  };
  EXPECT_THAT(with("version: 2", "version: 3"), HasSubstr("gdt.yaml:1: version: only versions 1 and 2 are read"));
  EXPECT_THAT(with("cap: 61440", "cap: 65536"), HasSubstr("cap: must be a whole number"));
  EXPECT_THAT(with("cap: 61440", "cap: 12.5"), HasSubstr("cap: must be a whole number"));
  EXPECT_THAT(with("cap: 61440", "cap: 61441"), HasSubstr("61441 is no multiple of the scale 12"));
  EXPECT_THAT(with("scale: 12", "scale: 0"), HasSubstr("scale: must be a whole number"));
  EXPECT_THAT(with("scale: 12", "ladder: 12"), HasSubstr("the key scale is missing"));
  EXPECT_THAT(with("scale: 12", "scale: 6"), HasSubstr("unit: must be"));
  EXPECT_THAT(with("image: gdt.png", "image: ../gdt.png"), HasSubstr("leads out"));
  put_file(folder / "gdt.yaml", text);
  for (const std::uint16_t level : {std::uint16_t{13}, std::uint16_t{61452}}) {
    put_file(folder / "gdt.png", encode_png({1, 1, {level}}));
    EXPECT_THAT(input_error_of([&] { read_distance_field(folder / "gdt.yaml"); }),
                HasSubstr(level == 13 ? "level 13, which is no multiple of the scale 12" : "above the cap 61440"));
  }
}

}  // namespace
}  // namespace gdtslam
