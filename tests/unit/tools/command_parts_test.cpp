// The parts of the command that have no test of their own: progress, run folder, settings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/did_you_mean.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/folder/run_pictures.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

TEST(Progress, ShowsShareCountRateAndTimeLeft) {
  EXPECT_EQ(ProgressLine::text("scans", 5730, 0.42, 2.0), " 42 %  5,730 scans  2,865/s  3 s left");
  EXPECT_EQ(ProgressLine::text("scans", 1234567, 0.5, 100.0), " 50 %  1,234,567 scans  12,345/s  1:40 min left");
  EXPECT_EQ(ProgressLine::text("scans", 100, 0.01, 100.0), "  1 %  100 scans  1/s  2:45 h left");
  EXPECT_EQ(ProgressLine::text("scans", 100, 1.0, 10.0), "100 %  100 scans  10/s  0 s left");
}

TEST(Progress, LeavesOutWhatIsNotKnown) {
  EXPECT_EQ(ProgressLine::text("records", 7, -1.0, 2.0), "7 records  3/s");
  EXPECT_EQ(ProgressLine::text("records", 0, 0.0, 0.0), "  0 %  0 records");
}

TEST(Printable, NothingThatATerminalObeysGetsThrough) {
  EXPECT_EQ(printable("b\u00fcro \u6f22 \U0001f600 \ufffd \\"), "b\u00fcro \u6f22 \U0001f600 \ufffd \\");
  EXPECT_EQ(printable("a\nb\r\tc\x1b[2J\x7f"), "a\\nb\\x0d\\x09c\\x1b[2J\\x7f");
  EXPECT_EQ(printable(std::string_view("\0", 1)), "\\x00");
  EXPECT_EQ(printable("\u009b2J\u2028"), "\\xc2\\x9b2J\\xe2\\x80\\xa8") << "C1 and the line separator";
  EXPECT_EQ(printable("a\u202egnp.exe"), "a\\xe2\\x80\\xaegnp.exe") << "from right to left";
  for (const char* const mark : {"\u200e", "\u200f", "\u202a", "\u202d", "\u2066", "\u2069", "\u061c"}) {
    EXPECT_THAT(printable(mark), testing::StartsWith("\\x")) << mark;
  }
  EXPECT_EQ(printable("\xff\xc3(\xe2\x82"), "\\xff\\xc3(\\xe2\\x82") << "no UTF-8";
  EXPECT_EQ(printable("a\n\tb\r", "\n\t"), "a\n\tb\\x0d");
  EXPECT_EQ(printable(""), "");
}

class RunFolderTest : public testing::Test {
 public:
  RunFolderTest() {
    std::string name = (fs::temp_directory_path() / "gdtslam-run-XXXXXX").string();
    work_ = ::mkdtemp(name.data());
  }
  ~RunFolderTest() override { fs::remove_all(work_); }

 protected:
  static void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
  static std::string read(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  fs::path work_;
};

// More than 32,767 pixels are refused by the rasteriser.
TEST_F(RunFolderTest, AnOverviewThatFailsCostsTheRunNoMoreThanThePicture) {
  std::vector<LogReader::Warning> warnings;
  for (const double width : {10.0, 40000.0}) {
    RunFolder run(work_, true);
    write_picture(run, "overview", Canvas(width, 10.0, "map"), warnings);
    run.commit();
  }
  EXPECT_TRUE(fs::is_empty(work_)) << "nor is the old one left";
  ASSERT_FALSE(warnings.empty());
  EXPECT_EQ(warnings.back().kind, "no picture overview");
}

TEST_F(RunFolderTest, LatestPointsToTheRunButReplacesNothingElse) {
  fs::create_directory(work_ / "one");
  fs::create_directory(work_ / "two");
  link_latest(work_ / "one");
  link_latest(work_ / "two");
  EXPECT_EQ(fs::read_symlink(work_ / "latest"), "two");
  fs::remove(work_ / "latest");
  write(work_ / "latest", "a file of the user");
  link_latest(work_ / "one");
  EXPECT_EQ(read(work_ / "latest"), "a file of the user");
}

TEST_F(RunFolderTest, ADefaultFolderIsFreeAlsoWhileOneIsWritten) {
  const fs::path before = fs::current_path();
  fs::current_path(work_);
  const std::string first = default_run_folder("drive.log");
  const RunFolder written(first);
  EXPECT_NE(default_run_folder("drive.log"), first);
  fs::current_path(before);
}

TEST(DefaultRunFolder, IsNamedAfterTheLog) {
  EXPECT_THAT(default_run_folder("../data/intel.clf.gz"), testing::MatchesRegex("runs/intel-[0-9]+T[0-9]+Z"));
  EXPECT_THAT(default_run_folder("drive.log"), testing::StartsWith("runs/drive-"));
  EXPECT_THAT(default_run_folder("-"), testing::StartsWith("runs/stdin-"));
}

TEST(Settings, CommandLineBeatsFileBeatsDefault) {
  std::string name = (fs::temp_directory_path() / "gdtslam-config-XXXXXX").string();
  const int descriptor = ::mkstemp(name.data());
  ASSERT_GE(descriptor, 0);
  ::close(descriptor);
  std::ofstream(name) << "version: 1\nmap: {resolution: 10 cm}\nmerge: {kappa: 0.75}\noccupancy: {min_ends: 4}\n";
  const Settings settings = load_settings({.file = name, .sets = {"merge.kappa=0.25", "merge.kappa=1"}});
  fs::remove(name);
  EXPECT_EQ(settings.mapper.map.resolution_m, 0.1);
  EXPECT_EQ(settings.mapper.merge.kappa, 1.0);
  EXPECT_EQ(settings.occupancy.min_ends, 4);
  EXPECT_EQ(settings.mapper.merge.threshold_m, MapperConfig{}.merge.threshold_m);
  EXPECT_THAT(settings.from_file, testing::UnorderedElementsAre("map.resolution", "merge.kappa", "occupancy.min_ends"));
  EXPECT_THAT(settings.from_sets, ElementsAre("merge.kappa", "merge.kappa"));
}

TEST(Settings, RefusesWhatDoesNotFit) {
  EXPECT_THROW(load_settings({.file = {}, .sets = {"occupancy.min_ends=0"}}), ConfigError);
  EXPECT_THROW(load_settings({.file = {}, .sets = {"map.truncation=50 m"}}), ConfigError);  // more than 255 cells
}

}  // namespace
}  // namespace gdtslam
