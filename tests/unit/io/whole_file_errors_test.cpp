// Errors of a file as a whole begin with its name alone; a number behind it would be a line that is not to blame.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::StartsWith;

// Files that people give in place of a log: each is called by its name, with what to do.
TEST(WholeFileErrors, OfFilesThatAreNoLogs) {
  const auto said = [](const std::string& bytes) {
    const TemporaryFolder folder;
    put_file(folder / "f", bytes);
    return told_by<InputError>([&] { drain(*open_log(folder / "f", {})); }, "no error").substr((folder / "f").size());
  };
  const std::string tum = "1.5 1 2 0 0 0 0.7 0.7\n";
  for (const auto& [bytes, words] : std::vector<std::pair<std::string, std::string>>{
           {"", ": is empty; give a CARMEN, CSV, JSON lines, ROS bag or MCAP log"},
           {"lorem ipsum\n", ": holds no complete CARMEN message in 1 lines; give a CARMEN"},
           {"\x89PNG\r\n\x1a\n", ": is a PNG picture, not a log; give a CARMEN"},
           {"# .PCD v0.7 - Point Cloud Data\nVERSION 0.7\n", ": is a PCD point cloud, not a log; give a CARMEN"},
           {tum, ": is a TUM trajectory, not a log"},
           {"# a comment\n" + tum, ": is a TUM trajectory, not a log"},
           {"\xef\xbb\xbf" + tum, ": is a TUM trajectory, not a log"},
           {"version https://git-lfs.github.com/spec/v1\n", ": is a pointer of Git LFS, not the file itself; 'git lfs"},
           {"header: \n  seq: 1\n", ": is text of 'rostopic echo', not a log; give the bag"},
           {"[{\"stamp\": 1}]\n", ": is a JSON array, not a log;"},
           {"{\n \"stamp\": 1\n}\n", ": is JSON over several lines, not a log;"},
           {"{ \"scans\": [\n1]}\n", ": is JSON over several lines, not a log;"}}) {
    EXPECT_THAT(said(bytes), StartsWith(words)) << bytes;
  }
}

}  // namespace
}  // namespace gdtslam
