// Sources when somebody was asked after a signal whether their wait goes on: pipes end, files do not. What hangs is
// ended by an alarm.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "engine/core/files/interruption.hpp"
#include "engine/io/byte_source.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

std::atomic<bool> g_is_end_asked_for = false;

/// The process is asked to end 0.1 s after all was read that waits in a descriptor, by a signal that interrupts no
/// wait.
class AskedSoon {
 public:
  explicit AskedSoon(int descriptor = -1) {
    ::alarm(100);
    asked_to_end = [] { return g_is_end_asked_for.load(); };
    thread_ = std::thread([descriptor] {
      int bytes = 0;
      do {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      } while (::ioctl(descriptor, FIONREAD, &bytes) == 0 && bytes > 0);
      g_is_end_asked_for = true;
    });
  }
  AskedSoon(const AskedSoon&) = delete;
  AskedSoon& operator=(const AskedSoon&) = delete;
  ~AskedSoon() {
    thread_.join();
    asked_to_end = nullptr;
    g_is_end_asked_for = false;
    ::alarm(0);
  }

 private:
  std::thread thread_;
};

std::string text_in(const std::string& path) { return read_all(*open_file_source(path), 100, path); }

TEST(AskedAfterSignals, TheInnermostAnswersUntilItGoes) {
  AskedAfterSignals::ask();
  EXPECT_FALSE(AskedAfterSignals::has_ended());
  int times = 0;
  const AskedAfterSignals outer([&times] { return ++times == 2; });
  AskedAfterSignals::ask();
  EXPECT_FALSE(AskedAfterSignals::has_ended());
  {
    const AskedAfterSignals inner([] { return true; });
    AskedAfterSignals::ask();
    EXPECT_TRUE(AskedAfterSignals::has_ended());
  }
  EXPECT_FALSE(AskedAfterSignals::has_ended());
  AskedAfterSignals::ask();
  EXPECT_TRUE(AskedAfterSignals::has_ended());
  AskedAfterSignals::ask();
  EXPECT_TRUE(AskedAfterSignals::has_ended()) << "whatever is answered later";
  EXPECT_EQ(times, 3);
}

TEST(AskedAfterSignals, FilesAreReadBehindTheEndAndPipesAreEmptyWithoutAWriter) {
  const TemporaryFolder folder;
  put_file(folder / "ten", "0123456789");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const AskedAfterSignals asked([] { return true; });
  AskedAfterSignals::ask();
  EXPECT_EQ(text_in(folder / "ten"), "0123456789");
  EXPECT_EQ(text_in(folder / "pipe"), "");
}

TEST(WaitingSource, ASignalThatInterruptsNoWaitEndsThatForAWriter) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const AskedSoon asked;
  try {
    open_file_source(folder / "pipe");
    FAIL() << "opened";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kInterrupted) << error.what();
  }
}

TEST(WaitingSource, ASignalThatInterruptsNoWaitEndsAPipe) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const int writer = ::open((folder / "pipe").c_str(), O_RDWR);
  ASSERT_EQ(::write(writer, "0123", 4), 4);
  const AskedSoon asked(writer);
  EXPECT_EQ(text_in(folder / "pipe"), "0123");
  ::close(writer);
}

TEST(WaitingSource, ASignalThatInterruptsNoWaitEndsATerminal) {
  const int ours = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_EQ(::grantpt(ours), 0);
  ASSERT_EQ(::unlockpt(ours), 0);
  const std::string name = ::ptsname(ours);
  const int theirs = ::open(name.c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(theirs, 0);
  ASSERT_EQ(::write(ours, "0123\n", 5), 5);
  const AskedSoon asked(theirs);
  EXPECT_EQ(text_in(name), "0123\n");
  ::close(theirs);
  ::close(ours);
}

TEST(WaitingSource, WhoeverWantsTheThreadToEndIsAskedWithoutASignalToo) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const int writer = ::open((folder / "pipe").c_str(), O_RDWR);
  ASSERT_EQ(::write(writer, "0123", 4), 4);
  ::alarm(100);
  const AskedAfterSignals asked([] { return true; });
  EXPECT_EQ(text_in(folder / "pipe"), "0123");
  ::alarm(0);
  ::close(writer);
}

}  // namespace
}  // namespace gdtslam
