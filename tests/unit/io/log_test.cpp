// Guessing the kind of a log by its content.
#include "gdtslam/io/log.hpp"

#include <gmock/gmock.h>

#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string refusal(const std::string& path) {
  try {
    open_log(path, {});
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(OpenLog, ReadsCarmenPlainAndPackedWhateverTheName) {
  const TemporaryFolder folder;
  const std::string text = "TILT 0.5 1 h 2\n";
  put_file(folder / "a.bag", text);
  put_file(folder / "b", gzip(text));
  EXPECT_EQ(drain(*open_log(folder / "a.bag", {})).records.size(), 1U);
  EXPECT_EQ(drain(*open_log(folder / "b", {})).records.size(), 1U);
}

TEST(OpenLog, NamesWhatItDoesNotRead) {
  const TemporaryFolder folder;
  struct Case {
    std::string name;
    std::string content;
    std::string kind;
  };
  for (const Case& c : {Case{"mcap", std::string("\x89MCAP0\r\n\0\0", 10), "an MCAP file"},
                        Case{"ros2.db3", std::string("SQLite format 3\0rest", 20), "SQLite"}}) {
    put_file(folder / c.name, c.content);
    EXPECT_THAT(refusal(folder / c.name), AllOf(HasSubstr(c.kind), HasSubstr("CARMEN"))) << c.name;
  }
}

TEST(OpenLog, NamesWhatIsDamagedAroundALog) {
  const TemporaryFolder folder;
  put_file(folder / "x.bz2", "BZh91AY&SYdamaged, for it goes on like nothing that bzip2 writes");
  put_file(folder / "x.zst", "\x28\xb5\x2f\xfd rest");
  put_file(folder / "x.xz", std::string("\xfd\x37zXZ\0\0\x01wrong header", 20));
  for (const std::string kind : {"bzip2", "zstd", "xz"}) {
    const std::string name = kind == "bzip2" ? "x.bz2" : kind == "zstd" ? "x.zst" : "x.xz";
    EXPECT_THAT(refusal(folder / name), AllOf(HasSubstr(name), HasSubstr("damaged " + kind + " data"))) << name;
  }
}

TEST(OpenLog, FoldersAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT(refusal(folder.path().string()), HasSubstr("is a folder"));
  put_file(folder / "metadata.yaml", "rosbag2_bagfile_information:\n");
  EXPECT_THAT(refusal(folder.path().string()), HasSubstr("is a ROS 2 bag"));
}

TEST(OpenLog, MissingFileIsAFileError) { EXPECT_THROW(open_log("/nowhere/log", {}), FileError); }

TEST(OpenLog, BagsAreToldByTheirFirstLinePlainAndPacked) {
  const TemporaryFolder folder;
  const std::string empty = "#ROSBAG V2.0\n";
  put_file(folder / "a.log", empty);
  put_file(folder / "b", gzip(empty));
  for (const char* const name : {"a.log", "b"}) {
    EXPECT_THROW(drain(*open_log(folder / name, {})), InputError);
    EXPECT_NO_THROW(open_log(folder / name, {})) << "a bag without scans is one all the same";
  }
}

}  // namespace
}  // namespace gdtslam
