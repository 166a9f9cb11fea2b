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

#include "engine/core/files/folder_calls.hpp"

namespace {

int failures_left = 0;
int failure_code = 0;

}  // namespace

// In place of the C library's, for this program. Fails as often as it is told to.
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

class FolderCalls : public ::testing::Test {
 protected:
  FolderCalls() {
    std::string name = testing::TempDir() + "folder_calls_XXXXXX";
    folder_ = mkdtemp(name.data());
    std::ofstream(folder_ / "a file") << "text";
    fs::create_directory(folder_ / "a folder");
  }
  ~FolderCalls() override {
    failures_left = 0;
    fs::remove_all(folder_);
  }

  // Lists the folder where opening it fails so often first.
  std::multiset<std::string> names(int times, int code) {
    failures_left = times;
    failure_code = code;
    std::multiset<std::string> names;
    for (const fs::path& path : list_folder(folder_, failed_)) names.insert(path.filename());
    return names;
  }

  fs::path folder_;
  std::error_code failed_;
};

const std::multiset<std::string> kBoth{"a file", "a folder"};

TEST_F(FolderCalls, ListWhatLiesInTheFolder) {
  EXPECT_EQ(names(0, 0), kBoth);
  EXPECT_FALSE(failed_);
}

TEST_F(FolderCalls, AnInterruptionIsNoFailure) {
  for (const int times : {1, 2, 7}) {
    EXPECT_EQ(names(times, EINTR), kBoth) << times;
    EXPECT_EQ(failures_left, 0) << times;
    EXPECT_FALSE(failed_) << times;
  }
}

TEST_F(FolderCalls, AFailureIsTold) {
  EXPECT_TRUE(names(1, EACCES).empty());
  EXPECT_EQ(failed_, std::errc::permission_denied);
}

TEST_F(FolderCalls, AFolderThatIsNotThereIsAFailure) {
  folder_ /= "none";
  EXPECT_TRUE(names(0, 0).empty());
  EXPECT_EQ(failed_, std::errc::no_such_file_or_directory);
  folder_ = folder_.parent_path();
}

TEST_F(FolderCalls, RemoveWhatLiesInFoldersAndNothingBehindLinks) {
  const fs::path gone = folder_ / "gone";
  fs::create_directories(gone / "deep" / "deeper");
  for (const char* name : {"file", "deep/file", "deep/deeper/file", ".hidden"}) std::ofstream(gone / name) << "text";
  fs::create_directory_symlink(folder_ / "a folder", gone / "link");
  fs::create_symlink("nowhere", gone / "deep" / "broken");
  std::ofstream(folder_ / "a folder" / "kept") << "text";
  failures_left = 3;
  failure_code = EINTR;
  remove_tree(gone, failed_);
  EXPECT_FALSE(failed_) << failed_.message();
  EXPECT_EQ(names(0, 0), kBoth);
  EXPECT_TRUE(fs::exists(folder_ / "a folder" / "kept"));
  remove_tree(gone, failed_);
  EXPECT_FALSE(failed_) << "nothing is there";
  remove_tree(folder_ / "a file", failed_);
  EXPECT_FALSE(failed_);
  EXPECT_FALSE(fs::exists(folder_ / "a file"));
}

TEST_F(FolderCalls, ALinkIsRemovedAndNotWhatItLeadsTo) {
  fs::create_directory_symlink("a folder", folder_ / "link");
  std::ofstream(folder_ / "a folder" / "kept") << "text";
  remove_tree(folder_ / "link", failed_);
  EXPECT_FALSE(failed_);
  EXPECT_EQ(names(0, 0), kBoth);
  EXPECT_TRUE(fs::exists(folder_ / "a folder" / "kept"));
}

TEST_F(FolderCalls, WhatCannotBeRemovedIsToldOfAndTheRestIsGone) {
  fs::create_directories(folder_ / "gone" / "deep");
  std::ofstream(folder_ / "gone" / "deep" / "file") << "text";
  std::ofstream(folder_ / "gone" / "file") << "text";
  failures_left = 1;  // of the folder itself: what is in it is not known
  failure_code = EIO;
  remove_tree(folder_ / "gone", failed_);
  EXPECT_EQ(failed_, std::errc::io_error);
  EXPECT_TRUE(fs::exists(folder_ / "gone" / "deep" / "file"));
  remove_tree(folder_ / "gone", failed_);
  EXPECT_FALSE(failed_);
  EXPECT_EQ(names(0, 0), kBoth);
}

}  // namespace
}  // namespace gdtslam::test
