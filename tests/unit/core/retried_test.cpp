#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <system_error>

#include "engine/core/retried.hpp"

namespace {

int failures_left = 0;
int failure_code = 0;

}  // namespace

// In place of the C library's, for this program: by this the standard library opens a folder that it lists. Fails as
// often as it is told to.
// NOLINTNEXTLINE(cert-dcl50-cpp): so it is declared
extern "C" int openat(int folder, const char* name, int flags, ...) {
  if (failures_left > 0) {
    --failures_left;
    errno = failure_code;
    return -1;
  }
  std::va_list rest;
  va_start(rest, flags);
  const unsigned mode = (flags & O_CREAT) != 0 ? va_arg(rest, unsigned) : 0;
  va_end(rest);
  return static_cast<int>(::syscall(SYS_openat, folder, name, flags, mode));
}

namespace gdtslam::test {
namespace {

namespace fs = std::filesystem;

class ListFolder : public ::testing::Test {
 protected:
  ListFolder() {
    std::string name = testing::TempDir() + "list_folder_XXXXXX";
    folder_ = mkdtemp(name.data());
    std::ofstream(folder_ / "a file") << "text";
    fs::create_directory(folder_ / "a folder");
  }
  ~ListFolder() override {
    failures_left = 0;
    fs::remove_all(folder_);
  }

  // Lists the folder where opening it fails so often first.
  std::multiset<std::string> names(int times, int code) {
    failures_left = times;
    failure_code = code;
    std::multiset<std::string> names;
    for (const fs::directory_entry& entry : list_folder(folder_, failed_)) names.insert(entry.path().filename());
    return names;
  }

  fs::path folder_;
  std::error_code failed_;
};

const std::multiset<std::string> kBoth{"a file", "a folder"};

TEST_F(ListFolder, GivesWhatLiesInTheFolder) {
  EXPECT_EQ(names(0, 0), kBoth);
  EXPECT_FALSE(failed_);
}

TEST_F(ListFolder, AnInterruptionIsNoFailure) {
  for (const int times : {1, 2, 7}) {
    EXPECT_EQ(names(times, EINTR), kBoth) << times;
    EXPECT_EQ(failures_left, 0) << times;
    EXPECT_FALSE(failed_) << times;
  }
}

TEST_F(ListFolder, AFailureIsTold) {
  EXPECT_TRUE(names(1, EACCES).empty());
  EXPECT_EQ(failed_, std::errc::permission_denied);
}

TEST_F(ListFolder, AFolderThatIsNotThereIsAFailure) {
  folder_ /= "none";
  EXPECT_TRUE(names(0, 0).empty());
  EXPECT_EQ(failed_, std::errc::no_such_file_or_directory);
  folder_ = folder_.parent_path();
}

}  // namespace
}  // namespace gdtslam::test
