// What a process keeps on disk has no name at any moment, so that a kill leaves nothing. The kernel tells what appears
// in the folder.
#include "engine/core/memory/scratch_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <string>

namespace gdtslam {
namespace {

class ScratchFileTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_NE(::mkdtemp(folder_.data()), nullptr); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string folder_ = testing::TempDir() + "gdtslam-scratch-test-XXXXXX";
};

TEST_F(ScratchFileTest, HasNoNameAtAnyMoment) {
  const int unnamed = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (unnamed < 0) GTEST_SKIP() << "the file system of " << folder_ << " has no files without names";
  ::close(unnamed);
  const int watch = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  ASSERT_GE(watch, 0);
  ASSERT_GE(::inotify_add_watch(watch, folder_.c_str(), IN_CREATE | IN_MOVED_TO), 0);
  std::array<std::byte, 3> read{};
  {
    ScratchFile file(folder_);
    file.write(5, std::array{std::byte{1}, std::byte{2}, std::byte{3}});
    file.read(4, read);
  }
  EXPECT_EQ(read, (std::array{std::byte{0}, std::byte{1}, std::byte{2}}));
  alignas(inotify_event) std::array<char, 4096> events{};
  EXPECT_EQ(::read(watch, events.data(), events.size()), -1);
  EXPECT_EQ(errno, EAGAIN) << "something had a name";
  ::close(watch);
}

}  // namespace
}  // namespace gdtslam
