// The one rule for what is kept in memory of a packed file: so much whatever the file has, and so much for each byte of
// it.
#include "engine/io/file_limits.hpp"

#include <stdlib.h>

#include "engine/io/maps/png.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

constexpr std::uint64_t kMib = std::uint64_t{1} << 20U;

/// The variable for the length of a test.
class UnpackedMib {
 public:
  explicit UnpackedMib(const char* value) { ::setenv("GDTSLAM_UNPACKED_MIB", value, 1); }
  UnpackedMib(const UnpackedMib&) = delete;
  UnpackedMib& operator=(const UnpackedMib&) = delete;
  ~UnpackedMib() { ::unsetenv("GDTSLAM_UNPACKED_MIB"); }
};

TEST(FileLimits, KeptBytesAreThoseOfTheRule) {
  EXPECT_NO_THROW(check_kept_bytes(256 * kMib, 0, "a"));
  EXPECT_THROW(check_kept_bytes(256 * kMib + 32, 0, "a"), InputError);
  EXPECT_NO_THROW(check_kept_bytes(256 * kMib + 32, 1, "a"));
  EXPECT_THROW(check_kept_bytes(256 * kMib + 64, 1, "a"), InputError);
  EXPECT_NO_THROW(check_kept_bytes(256 * kMib + 32 * 100 * kMib, 100 * kMib, "a"));
  EXPECT_THROW(check_kept_bytes(256 * kMib + 33 * 100 * kMib, 100 * kMib, "a"), InputError);
  EXPECT_NO_THROW(check_kept_bytes(1000 * kMib, 1000 * kMib, "a"));  // what is not packed, of any size
}

TEST(FileLimits, TheVariableSetsWhatIsFree) {
  {
    const UnpackedMib variable("1");
    EXPECT_NO_THROW(check_kept_bytes(kMib, 0, "a"));
    EXPECT_THROW(check_kept_bytes(kMib + 32, 0, "a"), InputError);
  }
  {
    const UnpackedMib variable("4096");
    EXPECT_NO_THROW(check_kept_bytes(4096 * kMib, 0, "a"));
  }
  for (const char* const wrong : {"0", "-1", "1.5", "much", "1048577", "99999999999999999999"}) {
    const UnpackedMib variable(wrong);
    EXPECT_THROW(check_kept_bytes(kMib, 0, "a"), ConfigError) << wrong;
  }
  const UnpackedMib empty("");
  EXPECT_NO_THROW(check_kept_bytes(256 * kMib, 0, "a"));
}

TEST(FileLimits, WhatIsMadeOfAFileMayBeSixteenTimesWhatIsFree) {
  const auto takes = [](std::uint64_t derived, std::uint64_t from_disk) {
    check_derived_bytes(derived, from_disk, "a", "looking");
  };
  EXPECT_NO_THROW(takes(4096 * kMib, 0));
  EXPECT_THROW(takes(4096 * kMib + 1, 0), InputError);
  EXPECT_NO_THROW(takes(4096 * kMib + 32, 1));
  EXPECT_THROW(takes(4096 * kMib + 33, 1), InputError);
  const UnpackedMib variable("257");
  EXPECT_NO_THROW(takes(4112 * kMib, 0));
  EXPECT_THROW(takes(4112 * kMib + 1, 0), InputError);
}

/// A picture of nothing but one level packs to a thousandth.
TEST(FileLimits, PicturesKeepToIt) {
  const Grey16Image image{2000, 1000, std::vector<std::uint16_t>(2'000'000, 0)};
  const std::string file = encode_png(image);
  ASSERT_LT(file.size(), 60'000U);
  EXPECT_EQ(decode_png_grey16(bytes_of(file), "t.png", kMib * 100).pixels, image.pixels);
  const UnpackedMib variable("1");
  EXPECT_THROW(decode_png_grey16(bytes_of(file), "t.png", kMib * 100), InputError);
}

}  // namespace
}  // namespace gdtslam
