// Files that appear whole or not at all, also when the disk is full, the folder is closed or the writer is killed.
#include "engine/io/atomic_file.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include "engine/core/files/interruption.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

TEST(AtomicFile, WritesTheBytes) {
  const TemporaryFolder folder;
  std::string expected;
  {
    AtomicFile file(folder / "a.txt");
    for (int i = 0; i < 50000; ++i) {
      file.write(std::to_string(i) + "\n");
      expected += std::to_string(i) + "\n";
    }
    const std::string large(300000, 'x');
    file.write(large);
    expected += large;
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
    file.commit();
  }
  EXPECT_EQ(get_file(folder / "a.txt"), expected);
  EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

// What the reader takes whole is no interrupted output.
TEST(AtomicFile, APipeThatTakesAllIsWrittenWhoeverAsksToEnd) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const int reader = ::open((folder / "pipe").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  bool (*const before)() = asked_to_end;
  asked_to_end = [] { return true; };
  EXPECT_NO_THROW({
    AtomicFile file(folder / "pipe");
    file.write("abc");
    file.commit();
  });
  asked_to_end = before;
  char bytes[4] = {};
  EXPECT_EQ(::read(reader, bytes, sizeof bytes), 3);
  EXPECT_STREQ(bytes, "abc");
  ::close(reader);
}

TEST(AtomicFile, KeepsPermissionsAndLinks) {
  const TemporaryFolder folder;
  put_file(folder / "a.txt", "old");
  ASSERT_EQ(::chmod((folder / "a.txt").c_str(), 0640), 0);
  std::filesystem::create_symlink("a.txt", folder / "link");
  write_file_atomically(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(get_file(folder / "a.txt"), "new");
  struct stat status {};
  ASSERT_EQ(::stat((folder / "a.txt").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0640U);
}

TEST(AtomicFile, FullDiskLeavesTheOldFile) {
  const TemporaryFolder folder;
  put_file(folder / "a.txt", "old");
  const BoundedRun run = run_alone([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100000, 100000};  // as if the disk were full behind this many bytes
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_file_atomically(folder / "a.txt", std::string(1000000, 'x'));
    } catch (const FileError& error) {
      return std::string(error.what()).find("a.txt: cannot be written") != std::string::npos ? 74 : 1;
    }
    return 0;
  });
  EXPECT_EQ(run.code, 74);
  EXPECT_EQ(get_file(folder / "a.txt"), "old");
  EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

TEST(AtomicFile, MissingFolderAndFolderAreFileErrors) {
  const TemporaryFolder folder;
  EXPECT_THROW(AtomicFile(folder / "none/a.txt"), FileError);
  EXPECT_THROW(AtomicFile(folder.path().string()), FileError);
  EXPECT_THAT(folder.names(), ElementsAre());
}

TEST(AtomicFile, ClosedFolderIsAFileErrorAndKeepsTheOldFile) {
  const TemporaryFolder folder;
  put_file(folder / "a.txt", "old");
  ASSERT_EQ(::chmod(folder.path().c_str(), 0555), 0);
  const BoundedRun run = run_alone([&] {
    constexpr uid_t kNobody = 65534;
    if (::geteuid() == 0 && ::setuid(kNobody) != 0) {  // permissions do not bind the superuser
      return 1;
    }
    try {
      write_file_atomically(folder / "a.txt", "new");
    } catch (const FileError& error) {
      return std::string(error.what()).find("a.txt: cannot be created: Permission denied") != std::string::npos ? 74
                                                                                                                : 2;
    }
    return 3;
  });
  ASSERT_EQ(::chmod(folder.path().c_str(), 0755), 0);
  EXPECT_EQ(run.code, 74);
  EXPECT_EQ(get_file(folder / "a.txt"), "old");
  EXPECT_THAT(folder.names(), ElementsAre("a.txt"));
}

TEST(AtomicFileSet, NamesAppearOnlyWhenAllIsOnTheDisk) {
  const TemporaryFolder folder;
  put_file(folder / "map.pgm", "old image");
  put_file(folder / "map.yaml", "old text");
  const BoundedRun run = run_alone([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      AtomicFileSet files;
      files.add(folder / "map.pgm").write("new image");
      // Held back in memory until the commit, when the disk turns out to be full.
      files.add(folder / "map.yaml").write(std::string(5000, 'x'));
      files.commit();
    } catch (const FileError&) {
      return 74;
    }
    return 0;
  });
  EXPECT_EQ(run.code, 74);
  EXPECT_EQ(get_file(folder / "map.pgm"), "old image");
  EXPECT_EQ(get_file(folder / "map.yaml"), "old text");
  EXPECT_THAT(folder.names(), UnorderedElementsAre("map.pgm", "map.yaml"));
}

TEST(CopyFileAtomically, CopiesBytesAndPermissions) {
  const TemporaryFolder folder;
  put_file(folder / "a", std::string(3000000, 'x'));
  ASSERT_EQ(::chmod((folder / "a").c_str(), 0640), 0);
  copy_file_atomically(folder / "a", folder / "b");
  EXPECT_EQ(get_file(folder / "b"), std::string(3000000, 'x'));
  struct stat status {};
  ASSERT_EQ(::stat((folder / "b").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0640U);
  EXPECT_THROW(copy_file_atomically(folder / "none", folder / "c"), FileError);
  EXPECT_THAT(folder.names(), UnorderedElementsAre("a", "b"));
}

TEST(MakeFolder, MakesAndAcceptsFoldersOnly) {
  const TemporaryFolder folder;
  make_folder(folder / "x/y");
  make_folder(folder / "x/y");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "x/y"));
  put_file(folder / "file", "");
  EXPECT_THROW(make_folder(folder / "file"), FileError);
  EXPECT_THROW(make_folder(folder / "file/below"), FileError);
}

}  // namespace
}  // namespace gdtslam
