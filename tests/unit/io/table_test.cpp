// CSV and JSON lines: every column, what is wrong with rows, each cut. Expected values are those of the text.
#include <gmock/gmock.h>

#include <cmath>

#include "engine/io/tables/table_reader.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr float kInfinite = std::numeric_limits<float>::infinity();

WholeLog read_rows(TableKind kind, std::string_view text, const ReadOptions& options = {}) {
  return drain(*open_table(kind, source_of(bytes_of(text)), "t", options));
}
WholeLog read_csv(std::string_view text, const ReadOptions& options = {}) {
  return read_rows(TableKind::kCsv, text, options);
}
WholeLog read_lines(std::string_view text, const ReadOptions& options = {}) {
  return read_rows(TableKind::kJsonLines, text, options);
}

std::string table_error(TableKind kind, std::string_view text, const ReadOptions& options = {}) {
  try {
    read_rows(kind, text, options);
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "no error";
}
std::string csv_error(std::string_view text) { return table_error(TableKind::kCsv, text); }
std::string json_error(std::string_view text) { return table_error(TableKind::kJsonLines, text); }

constexpr std::string_view kCsvDrive =
    "Stamp, yaw ,x,y,angle_min,angle_increment,range_max,laser_x,laser_y,laser_theta,ranges,ticks\n"
    "12.5,0.25,1,2,-1.5,0.5,30,0.1,0.2,0.3,1.25 2.5 inf,\n"
    "\n# a remark\n"
    "12.75,0.5,1.5,2.5,,,,,,,,77\n"
    "13,,,,,,,,,,\"[3.5, 4.25]\",\r\n";

void expect_drive(const WholeLog& log) {
  const auto scans = log.of<ScanRecord>();
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0].scan.stamp_s, 12.5);
  EXPECT_EQ(scans[0].T_odom_base, (Pose2{1.0, 2.0, 0.25}));
  EXPECT_EQ(scans[0].scan.T_base_laser, (Pose2{0.1, 0.2, 0.3}));
  EXPECT_EQ(scans[0].scan.first_bearing_rad, -1.5);
  EXPECT_EQ(scans[0].scan.bearing_step_rad, 0.5);
  EXPECT_EQ(scans[0].scan.max_range_m, 30.0);
  EXPECT_THAT(scans[0].scan.ranges_m, ElementsAre(1.25F, 2.5F, kInfinite));
  EXPECT_EQ(scans[1].scan.stamp_s, 13.0);
  EXPECT_FALSE(scans[1].T_odom_base);
  EXPECT_EQ(scans[1].scan.first_bearing_rad, -1.5) << "what the row before said of the sensor";
  EXPECT_EQ(scans[1].scan.T_base_laser, (Pose2{0.1, 0.2, 0.3}));
  EXPECT_THAT(scans[1].scan.ranges_m, ElementsAre(3.5F, 4.25F));
  const auto odometry = log.of<Odometry>();
  ASSERT_EQ(odometry.size(), 1U);
  EXPECT_EQ(odometry[0].stamp_s, 12.75);
  EXPECT_EQ(odometry[0].T_odom_base, (Pose2{1.5, 2.5, 0.5}));
  const auto encoders = log.of<Encoder>();
  ASSERT_EQ(encoders.size(), 1U);
  EXPECT_EQ(encoders[0].ticks, 77);
}

TEST(Csv, ReadsWhatItsHeaderNames) { expect_drive(read_csv(kCsvDrive)); }

TEST(JsonLines, ReadTheSame) {
  expect_drive(read_lines(
      "{\"stamp\":12.5,\"odom\":[1,2,0.25],\"mount\":[0.1,0.2,0.3],\"angle_min\":-1.5,\"angle_increment\":0.5,"
      "\"range_max\":30,\"ranges\":[1.25,2.5,null]}\n"
      "{\"stamp\":12.75,\"odom\":[1.5,2.5,0.5],\"ticks\":77}\n"
      " { \"stamp\" : 13.0 , \"ranges\" : [ 3.5, 4.25 ] }"));
}

TEST(JsonLines, NullIsNoReturnAndNoFault) {
  const WholeLog log = read_lines("{\"stamp\":1,\"angle_min\":0,\"angle_increment\":0.5,\"ranges\":[1.25,null,NaN]}\n");
  EXPECT_THAT(log.of<ScanRecord>().at(0).scan.ranges_m, ElementsAre(1.25F, kInfinite, kInfinite));
  EXPECT_EQ(log.warned("range not a number"), 1U);
}

TEST(Csv, TakesAColumnForEachRange) {
  const WholeLog log =
      read_csv("stamp,angle_min,angle_max,r0,r1,r2,battery\n1,-1,1,5,6,7,12\n2,,,5,,7,12\n3,,,5,6,,12\n4,,,,,,12\n",
               {.lenient = true});
  const auto scans = log.of<ScanRecord>();
  ASSERT_EQ(scans.size(), 3U);
  EXPECT_THAT(scans[0].scan.ranges_m, ElementsAre(5.0F, 6.0F, 7.0F));
  EXPECT_EQ(scans[0].scan.bearing_step_rad, 1.0);
  EXPECT_THAT(scans[1].scan.ranges_m, ElementsAre(5.0F, kInfinite, 7.0F));
  EXPECT_THAT(scans[2].scan.ranges_m, ElementsAre(5.0F, 6.0F));
  EXPECT_EQ(scans[2].scan.bearing_step_rad, 2.0) << "from the first to the last of two";
  EXPECT_EQ(log.warned("column not used"), 1U);
  EXPECT_EQ(log.warned("malformed line"), 1U) << "a row that says nothing";
}

TEST(Csv, TurnsAClockwiseLaserRightToLeft) {
  const auto scans = read_csv(
                         "stamp,angle_min,angle_increment,first_beam_after,time_increment,ranges\n"
                         "1,1,-0.5,0.25,0.125,7 8 9\n")
                         .of<ScanRecord>();
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_THAT(scans[0].scan.ranges_m, ElementsAre(9.0F, 8.0F, 7.0F));
  EXPECT_EQ(scans[0].scan.first_bearing_rad, 0.0);
  EXPECT_EQ(scans[0].scan.bearing_step_rad, 0.5);
  EXPECT_EQ(scans[0].scan.first_beam_after_s, 0.5);
  EXPECT_EQ(scans[0].scan.beam_period_s, -0.125);
}

TEST(Table, ACloudBecomesAScanByBearing) {
  const auto scans = read_lines("{\"stamp\":1,\"points\":[[3,4],[6,8],[0,-2],[-1,0]]}\n").of<ScanRecord>();
  ASSERT_EQ(scans.size(), 1U);
  const LaserScan& scan = scans[0].scan;
  std::vector<std::pair<double, float>> found;
  for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
    if (std::isfinite(scan.ranges_m[k])) {
      found.emplace_back(scan.first_bearing_rad + static_cast<double>(k) * scan.bearing_step_rad, scan.ranges_m[k]);
    }
  }
  ASSERT_EQ(found.size(), 3U) << "of two in one direction the nearer";
  const double half_step_rad = rad_from_deg(0.025) + 1e-12;
  EXPECT_EQ(found[0].second, 1.0F);
  EXPECT_NEAR(std::fabs(found[0].first), kPi, half_step_rad);
  EXPECT_EQ(found[1].second, 2.0F);
  EXPECT_NEAR(found[1].first, -kPi / 2, half_step_rad);
  EXPECT_EQ(found[2].second, 5.0F);
  EXPECT_NEAR(found[2].first, 0.9272952180016122, half_step_rad) << "atan(4/3)";
}

TEST(Csv, NamesLineAndColumnOfWhatIsWrong) {
  const std::string head = "stamp,x,y,theta,angle_min,angle_increment,ranges\n";
  EXPECT_THAT(csv_error(head + "1,0,0,0,0,1,5 6\n2,0,zero,0,,,5\n"), HasSubstr("t:3: the row has \"zero\" as its y"));
  EXPECT_THAT(csv_error(head + "1,0,0,0,0,1,5 6x\n"), HasSubstr("\"6x\" among its ranges"));
  EXPECT_THAT(csv_error(head + "1,0,0,,0,1,5 6\n"), HasSubstr("has no theta"));
  EXPECT_THAT(csv_error(head + "1,0,0,0,0,1\n"), HasSubstr("has 6 cells where the header names 7"));
  EXPECT_THAT(csv_error(head + "1,0,0,0,,,5 6\n"), HasSubstr("angle_increment"));
  EXPECT_THAT(csv_error(head + "1,0,0,0,-90,1,5 6\n"), HasSubstr("radians"));
  EXPECT_THAT(csv_error(head + ",0,0,0,0,1,5 6\n"), HasSubstr("has no stamp"));
  EXPECT_THAT(csv_error(head + "inf,0,0,0,0,1,5 6\n"), HasSubstr("not finite"));
  EXPECT_THAT(csv_error(head + "1,0,0,0,0,1,\"5 6\n"), HasSubstr("quotation mark"));
  EXPECT_THAT(csv_error("stamp,rangse\n1,2\n"),
              HasSubstr("t:1: the header names a column \"rangse\"; did you mean 'ranges'?"));
  EXPECT_THAT(csv_error("x,y\n1,2\n"), HasSubstr("names no column stamp"));
  EXPECT_THAT(csv_error("stamp,ranges,ranges\n1,2,3\n"), HasSubstr("twice"));
  EXPECT_THAT(csv_error("stamp;ranges\n1;2\n"), HasSubstr("by commas"));
  EXPECT_THAT(csv_error("stamp,ranges\n"), HasSubstr("without a complete row"));
}

TEST(JsonLines, NameWhatIsWrong) {
  EXPECT_THAT(json_error("{\"stamp\":1,\"odom\":[1,2]}\n"), HasSubstr("t:1: the row has 2 numbers as its odom"));
  EXPECT_THAT(json_error("{\"stamp\":1,\"angel_min\":1}\n"), HasSubstr("did you mean 'angle_min'?"));
  EXPECT_THAT(json_error("{\"stamp\":}\n"), HasSubstr("is no JSON at"));
  EXPECT_THAT(json_error("{\"stamp\":1,\"odom\":[1,2,3]} x\n"), HasSubstr("is no JSON at"));
  EXPECT_THAT(json_error("{\"stamp\":1,\"points\":[[[1]]]}\n"), HasSubstr("pairs"));
  EXPECT_THAT(json_error("{\"stamp\":1,\"ranges\":[1],\"points\":[1,2]}\n"), HasSubstr("both"));
  EXPECT_THAT(json_error("{\"a\":" + std::string(60, '[') + "\n"), HasSubstr("brackets"));
  const WholeLog log =
      read_lines("{\"stamp\":1,\"odom\":[1,2,3],\"extra\":{\"a\":[1,{\"b\":\"\\\"]\"}],\"c\":true}}\n");
  EXPECT_EQ(log.of<Odometry>().size(), 1U);
  EXPECT_EQ(log.warned("key not used"), 1U);
}

// Sixteen brackets may stand within the outermost one of a value that nobody reads.
TEST(JsonLines, SkipBracketsInBracketsToADepth) {
  const auto line_of = [](std::size_t brackets) {
    return "{\"stamp\":1,\"odom\":[1,2,3],\"extra\":" + std::string(brackets, '[') + std::string(brackets, ']') + "}\n";
  };
  EXPECT_EQ(read_lines(line_of(17)).of<Odometry>().size(), 1U);
  EXPECT_THAT(json_error(line_of(18)), HasSubstr("too many brackets in brackets"));
}

TEST(Table, StatedOptionsBeatTheFile) {
  const ReadOptions options{
      .first_bearing_rad = 0.5, .bearing_step_rad = 0.25, .max_range_m = 9.0, .T_base_laser = Pose2{1.0, 0.0, 0.0}};
  const auto scans = read_csv(kCsvDrive, options).of<ScanRecord>();
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0].scan.first_bearing_rad, 0.5);
  EXPECT_EQ(scans[0].scan.bearing_step_rad, 0.25);
  EXPECT_EQ(scans[0].scan.max_range_m, 9.0);
  EXPECT_EQ(scans[0].scan.T_base_laser, (Pose2{1.0, 0.0, 0.0}));
}

TEST(OpenLog, TellsTablesByTheirFirstBytes) {
  const TemporaryFolder folder;
  put_file(folder / "a", "\xef\xbb\xbfstamp,x,y,theta\n1,2,3,4\n");
  put_file(folder / "b", "{\"stamp\":1,\"odom\":[2,3,4]}\n");
  put_file(folder / "c", gzip("\"stamp\",\"x\",\"y\",\"theta\"\n1,2,3,4\n"));
  for (const std::string name : {"a", "b", "c"}) {
    const auto odometry = drain(*open_log(folder / name, {})).of<Odometry>();
    ASSERT_EQ(odometry.size(), 1U) << name;
    EXPECT_EQ(odometry[0].T_odom_base, (Pose2{2.0, 3.0, 4.0})) << name;
  }
}

TEST(Carmen, ReadsItsSecondLaserWhereAllAreWanted) {
  constexpr std::string_view kLog =
      "FLASER 1 5 0 0 0 0 0 0 1 h 1\nRLASER 1 6 0.5 0 3 0 0 0 2 h 2\n"
      "ROBOTLASER2 0 -1 1 0.5 80 0.01 0 2 7 8 0 0 0 0 0 0 0 0 0 0 0 0 3 h 3\n";
  EXPECT_EQ(read_text(kLog).of<ScanRecord>().size(), 1U);
  EXPECT_EQ(read_text(kLog).warned("skipped message RLASER"), 1U);
  const auto scans = read_text(kLog, {.all_lasers = true}).of<ScanRecord>();
  ASSERT_EQ(scans.size(), 3U);
  EXPECT_EQ(scans[0].laser, 0U);
  EXPECT_EQ(scans[1].laser, 1U);
  EXPECT_EQ(scans[1].scan.T_base_laser, (Pose2{0.5, 0.0, 3.0}));
  EXPECT_EQ(scans[2].laser, 1U);
  EXPECT_THAT(scans[2].scan.ranges_m, ElementsAre(7.0F, 8.0F));
}

}  // namespace
}  // namespace gdtslam
