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

constexpr std::string_view kFirstRow = ",stamp,x,y,theta\n7,1,2,3,4\n";

std::size_t odometry_of(const std::string& text) {
  const TemporaryFolder folder;
  put_file(folder / "a", text);
  return drain(*open_log(folder / "a", {})).of<Odometry>().size();
}

// A name of letters, digits and underlines, in quotes or not, up to 63 of them, and a comma.
TEST(OpenLog, ACsvHeaderBeginsWithAName) {
  for (const char letter : {'a', 'z', 'A', 'Z', '0', '9', '_'}) {
    EXPECT_EQ(odometry_of(letter + std::string(kFirstRow)), 1U) << letter;
  }
  EXPECT_EQ(odometry_of("\"a\"" + std::string(kFirstRow)), 1U);
  for (const char letter : {'`', '@', '[', '/', ':', ' ', '-', '.'}) {
    EXPECT_THROW(odometry_of(letter + std::string(kFirstRow)), InputError) << letter;
  }
  EXPECT_EQ(odometry_of(std::string(63, 'n') + std::string(kFirstRow)), 1U);
  EXPECT_THROW(odometry_of(std::string(64, 'n') + std::string(kFirstRow)), InputError);
  EXPECT_THROW(odometry_of(std::string(kFirstRow)), InputError) << "a comma alone";
  EXPECT_THAT(told_by<InputError>([] { (void)odometry_of("stamp;x\n1;2\n"); }),
              HasSubstr("separate columns by commas"));
}

TEST(OpenLog, TextLogsHaveNoTopics) {
  const TemporaryFolder folder;
  put_file(folder / "csv", "stamp,x,y,theta\n1,2,3,4\n");
  put_file(folder / "jsonl", "{\"stamp\":1,\"odom\":[2,3,4]}\n");
  put_file(folder / "carmen", "TILT 0.5 1 h 2\n");
  std::vector<std::pair<std::string, ReadOptions>> wanted(4);
  wanted[0].first = "--topic";
  wanted[0].second.topics.scans = {"/scan"};
  wanted[1].first = "--odom";
  wanted[1].second.topics.odometry = "/odom";
  wanted[2].first = "--crank";
  wanted[2].second.topics.crank = "/crank";
  wanted[3].first = "the name in --mount NAME=x,y,yaw";
  wanted[3].second.topics.mounts = {{"/scan", Pose2{}}};
  for (const auto& [name, kind] :
       {std::pair("csv", "a CSV file"), {"jsonl", "a file of JSON lines"}, {"carmen", "a CARMEN log"}}) {
    EXPECT_NO_THROW(open_log(folder / name, {}));
    for (const auto& [option, options] : wanted) {
      EXPECT_EQ(told_by<UsageError>([&, &log_name = name, &given = options] { open_log(folder / log_name, given); }),
                folder / name + ": is " + kind + ", which has no topics: leave out " + option);
    }
  }
}

}  // namespace
}  // namespace gdtslam
