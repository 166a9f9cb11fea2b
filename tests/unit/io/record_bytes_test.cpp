// Numbers as bytes and back.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "bag_writer.hpp"
#include "engine/io/binary/bytes.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using namespace test;
using namespace std::string_literals;
using ::testing::HasSubstr;

const std::string kBytesName = "copy";

template <class Read>
std::string refusal_of_bytes(const std::string& bytes, const Read& read) {
  BytesIn in(bytes, kBytesName);
  return told_by<InputError>([&] { read(in); });
}

TEST(RecordBytes, NumbersOfSevenBitsAByte) {
  const std::vector<std::pair<std::uint64_t, std::string>> cases{
      {0, "\0"s},
      {1, "\1"s},
      {127, "\x7f"s},
      {128, "\x80\1"s},
      {300, "\xac\2"s},
      {16383, "\xff\x7f"s},
      {16384, "\x80\x80\1"s},
      {(std::uint64_t{1} << 63U) - 1, std::string(8, '\xff') + '\x7f'}};
  for (const auto& [value, bytes] : cases) {
    BytesOut out;
    EXPECT_EQ(out.varint(value).bytes(), bytes) << value;
    BytesIn in(bytes, kBytesName);
    EXPECT_EQ(in.varint(), value);
    EXPECT_EQ(in.left(), 0U);
  }
  const auto read = [](BytesIn& in) { (void)in.varint(); };
  EXPECT_EQ(refusal_of_bytes(std::string(8, '\x80') + '\1', read), "") << "nine bytes";
  EXPECT_THAT(refusal_of_bytes(std::string(9, '\x80') + '\1', read), HasSubstr("has a number of more than nine bytes"));
  EXPECT_THAT(refusal_of_bytes("\x80", read), HasSubstr("at byte 1, unpacked: ends within a number or a text"));
}

TEST(RecordBytes, ACountIsOfWhatCanBeThere) {
  const auto read = [](BytesIn& in) { (void)in.count("beams", 4); };
  EXPECT_EQ(refusal_of_bytes(raw(std::uint32_t{3}) + std::string(12, 'x'), read), "");
  EXPECT_EQ(refusal_of_bytes(raw(std::uint32_t{3}) + std::string(15, 'x'), read), "");
  EXPECT_THAT(refusal_of_bytes(raw(std::uint32_t{4}) + std::string(15, 'x'), read),
              HasSubstr("at byte 4, unpacked: has 4 beams by its own count, and 15 bytes are left"));
  EXPECT_THAT(refusal_of_bytes(raw(std::nan("")), [](BytesIn& in) { (void)in.number("a stamp"); }),
              HasSubstr("has a stamp that is not finite"));
}

}  // namespace
}  // namespace gdtslam
