// Records as bytes by docs/formats.md, "Log copies": where their fields lie, what frames hold, and what no reader
// gives.
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
#include "engine/io/binary/log_copy.hpp"
#include "engine/io/binary/log_copy_records.hpp"
#include "engine/io/binary/log_copy_writer.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using namespace test;
using namespace std::string_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kBytesName = "copy";

template <class Read>
std::string refusal_of_bytes(const std::string& bytes, const Read& read) {
  BytesIn in(bytes, kBytesName);
  return told_by<InputError>([&] { read(in); });
}

std::string refusal_of_record(const std::string& bytes) {
  return refusal_of_bytes(bytes, [](BytesIn& in) { (void)RecordCoder().record_from(in); });
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

TEST(RecordBytes, RecordsLieAsTheFormatSays) {
  EXPECT_EQ(record_bytes(Odometry{1.5, {2.0, -3.0, 0.25}}), "\1" + raw(1.5) + raw(2.0) + raw(-3.0) + raw(0.25));
  EXPECT_EQ(record_bytes(Encoder{1.5, -9007199254740993}), "\2" + raw(1.5) + raw(std::int64_t{-9007199254740993}));
  EXPECT_EQ(record_bytes(Tilt{1.5, -0.5}), "\3" + raw(1.5) + raw(-0.5));
  EXPECT_EQ(record_bytes(Parameter{"name", ""}), "\4" + sized("name") + sized(""));
}

ScanRecord scan_of_ranges(std::vector<float> ranges_m) {
  ScanRecord record;
  record.laser = 130;
  record.T_odom_base = Pose2{1.0, 2.0, 3.0};
  record.scan.stamp_s = 7.5;
  record.scan.first_bearing_rad = -1.0;
  record.scan.bearing_step_rad = 0.5;
  record.scan.max_range_m = 80.0;
  record.scan.first_beam_after_s = 0.01;
  record.scan.beam_period_s = 0.001;
  record.scan.T_base_laser = {0.1, 0.2, 0.3};
  record.scan.ranges_m = std::move(ranges_m);
  return record;
}

const std::string kScanBeforeRanges = "\0\5"s + raw(7.5) + "\x82\1"s + raw(1.0) + raw(2.0) + raw(3.0) + raw(-1.0) +
                                      raw(0.5) + raw(80.0) + raw(0.01) + raw(0.001) + raw(0.1) + raw(0.2) + raw(0.3);

// Twice a step up and one more, or twice a step down and two more; in millimetres.
TEST(RecordBytes, RangesOfWholeMillimetresAreSteps) {
  EXPECT_EQ(record_bytes(scan_of_ranges({0.06F, 0.061F, 0.059F, 0.059F, 1.0F, 0.0F})),
            kScanBeforeRanges + raw(std::uint32_t{6}) + "\0"s + "\x79\3\6\1"s + "\xdb\x0e"s + "\xd2\x0f"s);
}

TEST(RecordBytes, OtherRangesAreTheirFloatsInBetweenOrAllOfThem) {
  const float odd = 1.00049F;
  constexpr float kInf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(record_bytes(scan_of_ranges({0.06F, odd, 0.061F, kInf})),
            kScanBeforeRanges + raw(std::uint32_t{4}) + "\0\x79\0"s + raw(odd) + "\3\0"s + raw(kInf))
      << "half of them";
  EXPECT_EQ(record_bytes(scan_of_ranges({0.06F, odd, kInf})),
            kScanBeforeRanges + raw(std::uint32_t{3}) + "\1" + raw(0.06F) + raw(odd) + raw(kInf));
  EXPECT_EQ(record_bytes(scan_of_ranges({})), kScanBeforeRanges + raw(std::uint32_t{0}) + "\0"s);
  // A thousand kilometres: from there on floats, although they are whole millimetres.
  const std::string near = record_bytes(scan_of_ranges({999999.0F, 0.06F}));
  EXPECT_EQ(near.size(), kScanBeforeRanges.size() + 5 + 5 + 5) << "31 bits up, and down";
  const std::string far = record_bytes(scan_of_ranges({1.0e6F, 0.06F}));
  EXPECT_EQ(far, kScanBeforeRanges + raw(std::uint32_t{2}) + "\0\0"s + raw(1.0e6F) + "\x79");
}

TEST(RecordBytes, WhatScansHaveInCommonIsWrittenOnceAFrame) {
  BytesOut out;
  RecordCoder coder;
  const ScanRecord record = scan_of_ranges({});
  const std::size_t whole = record_bytes(record).size();
  coder.append(out, record);
  coder.append(out, record);
  EXPECT_EQ(out.size(), 2 * whole - 64);
  coder.begin_frame();
  coder.append(out, record);
  EXPECT_EQ(out.size(), 3 * whole - 64);
}

TEST(RecordBytes, WhatNoReaderGivesIsRefused) {
  const std::string ends = raw(std::uint32_t{0}) + "\0"s;
  EXPECT_EQ(refusal_of_record(kScanBeforeRanges + ends), "");
  const auto with_laser = [&](const std::string& laser) {
    return refusal_of_record("\0\4"s + raw(7.5) + laser + std::string(64, '\0') + ends);
  };
  EXPECT_EQ(with_laser("\x80\x80\4"), "") << "laser 65536";
  EXPECT_THAT(with_laser("\x81\x80\4"), HasSubstr("has a scan of laser 65537"));
  EXPECT_THAT(refusal_of_record("\0\x08"s + raw(7.5)), HasSubstr("has flags 8 that nothing is known of"));
  EXPECT_THAT(refusal_of_record("\0\0"s + raw(7.5) + "\0"s + ends), HasSubstr("has a scan before its laser"));
  EXPECT_THAT(refusal_of_record("\5"), HasSubstr("has a record of kind 5, which nothing is known of"));
  const auto with_ranges = [](std::uint32_t count, const std::string& bytes) {
    return refusal_of_record(kScanBeforeRanges + raw(count) + bytes);
  };
  EXPECT_THAT(with_ranges(0, "\2"), HasSubstr("has ranges of form 2, which nothing is known of"));
  EXPECT_THAT(with_ranges(1, "\1" + raw(-1.0F)), HasSubstr("has a range below zero or one that is not a number"));
  EXPECT_THAT(with_ranges(1, "\1" + raw(std::nanf(""))), HasSubstr("a range below zero or one that is not a number"));
  EXPECT_THAT(with_ranges(1, "\0\0"s + raw(-1.0F)), HasSubstr("has a range below zero"));
  EXPECT_EQ(with_ranges(2, "\0\3\4"s), "") << "up by one and down by one";
  EXPECT_THAT(with_ranges(2, "\0\3\6"s), HasSubstr("has a range of -1 mm"));
  BytesOut step;
  EXPECT_EQ(with_ranges(1, "\0"s + step.varint(2 * 999999937 + 1).take()), "");
  EXPECT_THAT(with_ranges(1, "\0"s + step.varint(2 * std::uint64_t{1000000000} + 1).take()),
              HasSubstr("has a range of 1000000000 mm"));
}

TEST(RecordBytes, AnEndHas128KindsOfWarningsAtMost) {
  const std::string warning = sized("") + raw(std::uint64_t{1}) + sized("");
  const auto end_of = [&](char is_whole, std::uint32_t count, const std::string& more = "") {
    std::string bytes = std::string(1, is_whole) + raw(count);
    for (std::uint32_t k = 0; k < count; ++k) bytes += warning;
    return refusal_of_bytes(bytes + more, [&](BytesIn& in) {
      const LogCopyEnd end = end_from(in);
      EXPECT_EQ(end.is_whole, is_whole == 1);
      EXPECT_EQ(end.warnings.size(), count);
    });
  };
  EXPECT_EQ(end_of(0, 0), "");
  EXPECT_EQ(end_of(1, 128), "");
  EXPECT_THAT(end_of(1, 129), HasSubstr("has 129 kinds of warnings"));
  EXPECT_THAT(end_of(2, 0), HasSubstr("has flags 2 that nothing is known of"));
  EXPECT_THAT(end_of(1, 1, "x"), HasSubstr("goes on behind its end"));
  BytesOut out;
  append_end(out, {.is_whole = true, .warnings = {{"kind", (std::uint64_t{5} << 32U) + 7, "first"}}});
  EXPECT_EQ(out.bytes(),
            "\1" + raw(std::uint32_t{1}) + sized("kind") + raw((std::uint64_t{5} << 32U) + 7) + sized("first"));
}

/// The number of records of each frame of a copy, that of its end left out.
std::vector<std::uint32_t> frames_of(const std::vector<LogRecord>& records) {
  const TemporaryFolder folder;
  LogCopyWriter writer;
  writer.write_into(folder / "a.copy");
  for (const LogRecord& record : records) writer.add(record);
  writer.end({.is_whole = true, .warnings = {}});
  const std::string bytes = get_file(folder / "a.copy");
  EXPECT_EQ(bytes.substr(0, 20), "gdtslam-log-copy" + raw(std::uint32_t{1}));
  std::vector<std::uint32_t> frames;
  for (std::size_t at = 20; at < bytes.size();) {
    BytesIn in(std::string_view(bytes).substr(at), kBytesName);
    const std::uint32_t packed_bytes = in.whole();
    frames.push_back(in.whole());
    at += 12 + packed_bytes;
    EXPECT_LE(at, bytes.size());
  }
  EXPECT_EQ(frames.back(), 0U);
  frames.pop_back();
  return frames;
}

TEST(RecordBytes, AFrameEndsWithWhatIsFiveSecondsAwayOrFills64KiB) {
  const auto at = [](std::initializer_list<double> stamps_s) {
    std::vector<LogRecord> records;
    for (const double stamp_s : stamps_s) records.emplace_back(Tilt{stamp_s, 0.0});
    return records;
  };
  EXPECT_THAT(frames_of(at({10.0, 12.0, 14.999})), ElementsAre(3U));
  EXPECT_THAT(frames_of(at({10.0, 14.999, 15.0, 16.0, 20.999, 21.0, 30.0})), ElementsAre(3U, 3U, 1U));
  EXPECT_THAT(frames_of(at({10.0, 5.001, 5.0, 4.0})), ElementsAre(3U, 1U)) << "a clock that was set back";
  // An odometry takes 33 bytes: 1985 of them 65505, one more 65538.
  std::vector<LogRecord> many(1985, Odometry{1.0, {}});
  EXPECT_THAT(frames_of(many), ElementsAre(1985U));
  many.insert(many.end(), 2, Odometry{1.0, {}});
  EXPECT_THAT(frames_of(many), ElementsAre(1986U, 1U));
}

}  // namespace
}  // namespace gdtslam
