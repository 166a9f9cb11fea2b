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
  return told_by<InputError>([&] { open_log(path, {}); }, "no error");
}

TEST(OpenLog, ReadsCarmenPlainAndPackedWhateverTheName) {
  const TemporaryFolder folder;
  const std::string text = "TILT 0.5 1 h 2\n";
  put_file(folder / "a.bag", text);
  put_file(folder / "b", gzip(text));
  EXPECT_EQ(drain(*open_log(folder / "a.bag", {})).records.size(), 1U);
  EXPECT_EQ(drain(*open_log(folder / "b", {})).records.size(), 1U);
}

TEST(OpenLog, ADamagedDatabaseIsNamed) {
  const TemporaryFolder folder;
  put_file(folder / "ros2.db3", std::string("SQLite format 3\0rest", 20));
  EXPECT_THAT(refusal(folder / "ros2.db3"), HasSubstr("ros2.db3"));
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

TEST(OpenLog, AFolderWithoutFilesOfABagIsNamed) {
  const TemporaryFolder folder;
  put_file(folder / "metadata.yaml", "rosbag2_bagfile_information:\n");
  try {
    drain(*open_log(folder.path().string(), {}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is a folder without .db3 and .mcap files"));
  }
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
