// Headers of clouds at the limits of docs/formats.md and just beyond; packed data by LZF's own rules.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "engine/io/clouds/cloud_file_layout.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using namespace std::string_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct CloudOutcome {
  Cloud points{};
  std::array<double, 3> origin_m{};
  std::string refusal{};
};
CloudOutcome outcome_of_cloud(const std::string& file, bool is_relative = false) {
  CloudOutcome outcome;
  try {
    CloudReader reader(bytes_of(file), "c");
    if (is_relative) reader.make_relative();
    outcome.points = reader.next();
    outcome.origin_m = reader.origin_m();
  } catch (const InputError& error) {
    outcome.refusal = error.what();
  }
  return outcome;
}

std::string times(int count, const std::string& text) {
  std::string all;
  for (int k = 0; k < count; ++k) all += text;
  return all;
}

/// A PLY file of one point, with lines before its vertex and properties behind x, y and z.
std::string ply_with(const std::string& before, const std::string& columns, const std::string& numbers) {
  return "ply\nformat ascii 1.0\n" + before +
         "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n" + columns + "end_header\n1 2 3" +
         numbers + "\n";
}

TEST(CloudLimits, PcdPointsAreWidthTimesHeight) {
  const auto points_of = [](const std::string& sizes) {
    return outcome_of_cloud("# .PCD v0.7\nFIELDS x y z\n" + sizes + "DATA ascii\n" + times(6, "1 2 3\n"));
  };
  EXPECT_EQ(points_of("WIDTH 2\nHEIGHT 3\n").points.size(), 6U);
  EXPECT_EQ(points_of("WIDTH 6\n").points.size(), 6U);
  EXPECT_EQ(points_of("POINTS 6\n").points.size(), 6U);
  EXPECT_EQ(points_of("POINTS 6\nHEIGHT 3\n").points.size(), 6U) << "a height needs a width";
  EXPECT_THAT(points_of("WIDTH 2\nHEIGHT 3\nPOINTS 5\n").refusal, HasSubstr("POINTS is 5, WIDTH times HEIGHT 6"));
  EXPECT_THAT(points_of("WIDTH 4294967296\nHEIGHT 4294967296\n").refusal, HasSubstr("is beyond all bounds"));
  EXPECT_THAT(points_of("WIDTH 9223372036854775808\nHEIGHT 2\n").refusal, HasSubstr("is beyond all bounds"));
  EXPECT_THAT(points_of("WIDTH 9223372036854775807\nHEIGHT 2\n").refusal, HasSubstr("ends after 6 of the"));
}

// Beyond ten kilometres, up to what grids of the earth have, whole kilometres are taken off.
TEST(CloudLimits, FarCloudsLoseTheirKilometres) {
  const auto origin_of = [](const std::string& x) {
    return outcome_of_cloud(
               "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\n"
               "property double z\nend_header\n" +
                   x + " 2 -30000.5\n",
               true)
        .origin_m;
  };
  EXPECT_THAT(origin_of("10000"), ElementsAre(0.0, 0.0, -31000.0));
  EXPECT_THAT(origin_of("10000.5"), ElementsAre(10000.0, 0.0, -31000.0));
  EXPECT_THAT(origin_of("-10000.5"), ElementsAre(-11000.0, 0.0, -31000.0));
  EXPECT_THAT(origin_of("999999999"), ElementsAre(999999000.0, 0.0, -31000.0));
  EXPECT_THAT(origin_of("1000000000"), ElementsAre(0.0, 0.0, -31000.0));
  EXPECT_THAT(origin_of("nan"), ElementsAre(0.0, 0.0, 0.0)) << "by a point that is finite";
}

TEST(CloudLimits, ScansAreNumberedFrom0To4294967295) {
  const auto scan_of = [](const std::string& number) {
    return outcome_of_cloud(ply_with("", "property double scan\n", " " + number));
  };
  EXPECT_EQ(scan_of("0").points.at(0).scan, 0U);
  EXPECT_EQ(scan_of("4294967295").points.at(0).scan, 4294967295U);
  for (const char* const number : {"4294967296", "-1", "0.5", "nan"}) {
    EXPECT_THAT(scan_of(number).refusal, HasSubstr("c:9: its scan number is none from 0 to 4294967295")) << number;
  }
}

// A byte below 32: so many bytes and one more follow as they are. Else its upper three bits are two less than the
// number of bytes to repeat (7: the next byte is added), and its lower five with the next byte one less than how far
// back.
TEST(Lzf, CopiesAndRepeats) {
  EXPECT_EQ(unpack_lzf("\0a"s, 1), "a");
  EXPECT_EQ(unpack_lzf("\2abc", 3), "abc");
  EXPECT_EQ(unpack_lzf("\x1f" + std::string(32, 'q'), 32), std::string(32, 'q'));
  EXPECT_EQ(unpack_lzf("\2abc\x20\2"s, 6), "abcabc") << "three from three back";
  EXPECT_EQ(unpack_lzf("\2abc\x20\0"s, 6), "abcccc") << "three from one back";
  EXPECT_EQ(unpack_lzf("\2abc\xc0\1"s, 11), "abcbcbcbcbc") << "eight from two back";
  EXPECT_EQ(unpack_lzf("\0a\xe0\0\0"s, 10), std::string(10, 'a')) << "nine";
  EXPECT_EQ(unpack_lzf("\0a\xe0\xff\0"s, 265), std::string(265, 'a')) << "264, the most";
  std::string far = times(10, "\x1f"s + std::string(32, 'x'));
  far[1] = 'F';
  EXPECT_EQ(unpack_lzf(far + "\x21\x3f"s, 323).value().substr(320), "Fxx") << "from 320 back";
}

}  // namespace
}  // namespace gdtslam
