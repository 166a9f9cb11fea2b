// What is written of a log reads back, in each format what it carries; messages of ROS by a reader of their own.
#include <gmock/gmock.h>

#include <limits>
#include <string>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/writers/log_writer.hpp"
#include "engine/io/writers/ros_messages.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

ScanRecord written_scan(double stamp_s, std::size_t laser = 0) {
  return {.scan = {.stamp_s = stamp_s,
                   .first_bearing_rad = -1.0,
                   .bearing_step_rad = 0.5,
                   .max_range_m = 20.0,
                   .ranges_m = {1.0F, 2.5F, 3.25F, 4.5F},
                   .T_base_laser = Pose2{0.5, -0.25, 0.0}},
          .T_odom_base = Pose2{0.25, 0.5, 0.125},
          .laser = laser};
}

std::vector<LogRecord> some_records() {
  return {Parameter{"robot_width", "0.5"},
          Odometry{10.0, {1.0, -2.0, 0.5}},
          written_scan(10.25),
          Encoder{10.5, -1234567},
          Tilt{10.625, -0.375},
          Odometry{10.75, {1.5, -2.0, -0.75}},
          written_scan(11.0)};
}

std::vector<LogReader::Warning> write_records(const std::string& path, const std::vector<LogRecord>& records) {
  AtomicFileSet files;
  const auto writer = make_log_writer(find_log_format(path, ""), path, {}, files);
  for (const LogRecord& record : records) writer->write(record);
  writer->finish();
  EXPECT_GT(writer->bytes(), 0U);
  files.commit();
  return writer->left_out();
}

std::vector<LogRecord> read_records(const std::string& path, const ReadOptions& options = {}) {
  std::vector<LogRecord> records;
  const auto log = open_log(path, options);
  while (auto record = log->next()) records.push_back(std::move(*record));
  return records;
}

void expect_pose(const Pose2& found, const Pose2& expected) {
  EXPECT_NEAR(found.x_m, expected.x_m, 1e-9);
  EXPECT_NEAR(found.y_m, expected.y_m, 1e-9);
  EXPECT_NEAR(found.theta_rad, expected.theta_rad, 1e-9);
}

void expect_scan(const ScanRecord& found, const ScanRecord& expected) {
  EXPECT_NEAR(found.scan.stamp_s, expected.scan.stamp_s, 1e-6);
  EXPECT_NEAR(found.scan.first_bearing_rad, expected.scan.first_bearing_rad, 1e-6);
  EXPECT_NEAR(found.scan.bearing_step_rad, expected.scan.bearing_step_rad, 1e-6);
  EXPECT_NEAR(found.scan.max_range_m, expected.scan.max_range_m, 1e-6);
  EXPECT_EQ(found.scan.ranges_m, expected.scan.ranges_m);
  expect_pose(found.scan.T_base_laser, expected.scan.T_base_laser);
}

class WrittenAsLines : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Formats, WrittenAsLines,
                         testing::Values("a.log", "a.log.gz", "a.csv", "a.jsonl", "a.jsonl.gz"), [](const auto& file) {
                           std::string name = file.param;
                           for (char& c : name) c = c == '.' ? '_' : c;
                           return name;
                         });

TEST_P(WrittenAsLines, EachRecordReadsBackInItsPlace) {
  const TemporaryFolder folder;
  const std::vector<LogRecord> records = some_records();
  EXPECT_TRUE(write_records(folder / GetParam(), records).empty());
  std::vector<LogRecord> read = read_records(folder / GetParam());
  // CARMEN tells the limit of its laser in a line of its own, where the number of beams does not tell the bearings.
  std::erase_if(read, [](const LogRecord& record) {
    const auto* parameter = std::get_if<Parameter>(&record);
    return parameter != nullptr && parameter->name != "robot_width";
  });
  ASSERT_EQ(read.size(), records.size());
  for (std::size_t k = 0; k < records.size(); ++k) ASSERT_EQ(read[k].index(), records[k].index()) << k;
  EXPECT_EQ(std::get<Parameter>(read[0]).value, "0.5");
  expect_pose(std::get<Odometry>(read[1]).T_odom_base, {1.0, -2.0, 0.5});
  EXPECT_EQ(std::get<Odometry>(read[1]).stamp_s, 10.0);
  expect_scan(std::get<ScanRecord>(read[2]), std::get<ScanRecord>(records[2]));
  expect_pose(*std::get<ScanRecord>(read[2]).T_odom_base, {0.25, 0.5, 0.125});
  EXPECT_EQ(std::get<Encoder>(read[3]).ticks, -1234567);
  EXPECT_EQ(std::get<Encoder>(read[3]).stamp_s, 10.5);
  EXPECT_EQ(std::get<Tilt>(read[4]).elevation_rad, -0.375);
  EXPECT_EQ(std::get<Tilt>(read[4]).stamp_s, 10.625);
  expect_pose(std::get<Odometry>(read[5]).T_odom_base, {1.5, -2.0, -0.75});
  expect_scan(std::get<ScanRecord>(read[6]), std::get<ScanRecord>(records[6]));
}

// A reader of recordings gives scans the odometry of their stamp.
TEST(WrittenAsMessages, ScansReadBackWithTheirOdometry) {
  const TemporaryFolder folder;
  std::vector<LogRecord> records{Odometry{10.0, {1.0, -2.0, 0.5}}, written_scan(10.0),
                                 Odometry{10.5, {1.5, -2.0, -0.75}}, written_scan(10.5),
                                 Odometry{11.0, {1.5, -2.0, -0.75}}};
  for (LogRecord& record : records) {
    if (auto* scan = std::get_if<ScanRecord>(&record)) scan->T_odom_base.reset();
  }
  EXPECT_TRUE(write_records(folder / "a.mcap", records).empty());
  std::vector<ScanRecord> scans;
  for (const LogRecord& record : read_records(folder / "a.mcap")) {
    if (const auto* scan = std::get_if<ScanRecord>(&record)) scans.push_back(*scan);
  }
  ASSERT_EQ(scans.size(), 2U);
  expect_scan(scans[0], std::get<ScanRecord>(records[1]));
  expect_scan(scans[1], std::get<ScanRecord>(records[3]));
  ASSERT_TRUE(scans[0].T_odom_base && scans[1].T_odom_base);
  expect_pose(*scans[0].T_odom_base, {1.0, -2.0, 0.5});
  expect_pose(*scans[1].T_odom_base, {1.5, -2.0, -0.75});
}

// Most readers keep the first transform of /tf_static.
TEST(WrittenAsMessages, AMountThatChangesIsTold) {
  const TemporaryFolder folder;
  ScanRecord moved = written_scan(10.5);
  moved.scan.T_base_laser.x_m += 0.25;
  ScanRecord again = written_scan(11.0);
  again.scan.T_base_laser = moved.scan.T_base_laser;
  const std::vector<LogReader::Warning> left_out = write_records(folder / "a.mcap", {written_scan(10.0), moved, again});
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_EQ(left_out[0].kind, "change of a mount");
  EXPECT_EQ(left_out[0].count, 1U);
}

TEST(CarmenLogs, SayWhatTheyCannotCarry) {
  const TemporaryFolder folder;
  ScanRecord timed = written_scan(1.0);
  timed.scan.beam_period_s = 0.001;
  ScanRecord bare = written_scan(2.0);
  bare.T_odom_base.reset();
  ScanRecord turned = written_scan(3.0);
  turned.scan.first_bearing_rad = 0.5;
  turned.scan.bearing_step_rad = -0.5;
  const std::vector<LogReader::Warning> left_out =
      write_records(folder / "a.log", {Parameter{"two words", "1"}, Parameter{"name", "two words"},
                                       Parameter{"name", ""}, written_scan(0.5, 2), timed, bare, turned});
  std::vector<std::pair<std::string, std::uint64_t>> kinds;
  for (const LogReader::Warning& warning : left_out) kinds.emplace_back(warning.kind, warning.count);
  EXPECT_THAT(kinds,
              testing::UnorderedElementsAre(std::pair("parameter", 3U), std::pair("scan of a third laser", 1U),
                                            std::pair("time of each beam", 1U), std::pair("missing odometry", 1U)));
  std::vector<ScanRecord> scans;
  for (const LogRecord& record : read_records(folder / "a.log")) {
    if (const auto* scan = std::get_if<ScanRecord>(&record)) scans.push_back(*scan);
  }
  ASSERT_EQ(scans.size(), 3U);
  expect_pose(*scans[1].T_odom_base, {0.25, 0.5, 0.125});  // that of the odometry before
  // Beams from left to right are written from right to left, each where it was.
  EXPECT_NEAR(scans[2].scan.first_bearing_rad, -1.0, 1e-9);
  EXPECT_NEAR(scans[2].scan.bearing_step_rad, 0.5, 1e-9);
  EXPECT_THAT(scans[2].scan.ranges_m, ElementsAre(4.5F, 3.25F, 2.5F, 1.0F));
}

TEST(LogFormats, AreToldByTheirEndings) {
  const std::vector<std::pair<std::string, LogFormat>> endings{
      {"a.log", LogFormat::kCarmen}, {"a.clf", LogFormat::kCarmen}, {"a.log.gz", LogFormat::kCarmen},
      {"a.csv", LogFormat::kCsv},    {"a.csv.gz", LogFormat::kCsv}, {"a.jsonl", LogFormat::kJsonLines},
      {"a.mcap", LogFormat::kMcap}};
  for (const auto& [path, format] : endings) EXPECT_EQ(log_format_by_ending(path), format) << path;
  EXPECT_FALSE(log_format_by_ending("a.txt"));
  EXPECT_EQ(find_log_format("a.txt", "csv"), LogFormat::kCsv);
  EXPECT_EQ(find_log_format("a.log", "mcap"), LogFormat::kMcap) << "what is said counts";
  EXPECT_THROW(find_log_format("a.txt", ""), UsageError);
  for (const char* bag : {"a.bag", "a.bag.gz", "a.db3", "folder/"}) {
    EXPECT_THAT(told_by<UsageError>([bag] { (void)find_log_format(bag, ""); }), HasSubstr("rosbags-convert")) << bag;
  }
  try {
    find_log_format("a.log", "carmem");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("carmen"));
  }
}

class TableFormats : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Formats, TableFormats, testing::Values("a.csv", "a.jsonl"),
                         [](const auto& file) { return std::string(file.param).substr(2); });

TEST_P(TableFormats, EachFieldOfAScanReadsBack) {
  constexpr float kNone = std::numeric_limits<float>::infinity();
  const TemporaryFolder folder;
  ScanRecord full = written_scan(10.125, 3);
  full.scan.first_beam_after_s = 0.5;
  full.scan.beam_period_s = -0.125;
  full.scan.T_base_laser.theta_rad = -3.0;
  full.scan.ranges_m = {0.1F, kNone, 0.0F, kNone};
  ScanRecord empty = full;
  empty.scan.ranges_m.clear();
  empty.T_odom_base.reset();
  EXPECT_TRUE(write_records(folder / GetParam(), {full, empty}).empty());
  const std::vector<LogRecord> read = read_records(folder / GetParam());
  ASSERT_EQ(read.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& found = std::get<ScanRecord>(read[k]);
    const ScanRecord& written = k == 0 ? full : empty;
    EXPECT_EQ(found.scan.stamp_s, 10.125);
    EXPECT_EQ(found.laser, 3U);
    EXPECT_EQ(found.scan.ranges_m, written.scan.ranges_m);
    EXPECT_EQ(found.scan.first_beam_after_s, 0.5);
    EXPECT_EQ(found.scan.beam_period_s, -0.125);
    EXPECT_EQ(found.scan.first_bearing_rad, -1.0);
    EXPECT_EQ(found.scan.bearing_step_rad, 0.5);
    EXPECT_EQ(found.scan.max_range_m, 20.0);
    EXPECT_EQ(found.scan.T_base_laser, full.scan.T_base_laser);
    EXPECT_EQ(found.T_odom_base, written.T_odom_base);
  }
}

// A record of CSV is a line: a line end in a text becomes a blank there.
TEST_P(TableFormats, TextsKeepTheirLetters) {
  const bool is_csv = std::string(GetParam()) == "a.csv";
  for (const std::string text : {"plain", "a,b", "a \"b\" c", "\"", " a", "a\tb", "a\nb\r", "\xc3\xa4", "{}[]:"}) {
    const TemporaryFolder folder;
    write_records(folder / GetParam(), {Parameter{"n" + text, text}});
    const auto parameter = std::get<Parameter>(read_records(folder / GetParam()).at(0));
    std::string expected = text;
    for (char& c : expected) c = is_csv && (c == '\n' || c == '\r') ? ' ' : c;
    EXPECT_EQ(parameter.value, expected) << text;
    EXPECT_EQ(parameter.name, "n" + expected) << text;
  }
}

}  // namespace
}  // namespace gdtslam
