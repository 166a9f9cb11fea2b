// Lines and remarks for readers that take none: pipes, sockets and terminals that are full. What hangs is ended by an
// alarm.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <climits>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/live/output/line_output.hpp"
#include "tools/gdtslam/live/remarks.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::Lt;
using ::testing::StartsWith;

/// Ends the process where the test takes longer.
class Alarm {
 public:
  Alarm() { ::alarm(100); }
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;
  ~Alarm() { ::alarm(0); }
};

/// What is written to `theirs` can be read from `ours`.
struct Ends {
  Ends() = default;
  Ends(const Ends&) = delete;
  Ends& operator=(const Ends&) = delete;
  ~Ends() {
    ::close(ours);
    ::close(theirs);
  }
  int ours = -1;
  int theirs = -1;
};

void open_small_pipe(Ends& ends) {
  std::array<int, 2> both{};
  ASSERT_EQ(::pipe(both.data()), 0);
  ends.ours = both[0];
  ends.theirs = both[1];
  ASSERT_EQ(::fcntl(ends.theirs, F_SETPIPE_SZ, PIPE_BUF), PIPE_BUF);
}

void open_small_socket(Ends& ends) {
  std::array<int, 2> both{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, both.data()), 0);
  ends.ours = both[0];
  ends.theirs = both[1];
  const int bytes = 1;  // the least there can be
  ASSERT_EQ(::setsockopt(ends.theirs, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof(bytes)), 0);
}

void open_terminal(Ends& ends) {
  ends.ours = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(ends.ours, 0);
  ASSERT_EQ(::grantpt(ends.ours), 0);
  ASSERT_EQ(::unlockpt(ends.ours), 0);
  std::array<char, 64> name{};
  ASSERT_EQ(::ptsname_r(ends.ours, name.data(), name.size()), 0);
  ends.theirs = ::open(name.data(), O_RDWR | O_NOCTTY);
  ASSERT_GE(ends.theirs, 0);
}

/// What is there, and what comes within a fifth of a second.
std::string read_from(int descriptor) {
  constexpr int kPause_ms = 200;
  std::string text;
  std::array<char, PIPE_BUF> part{};
  pollfd input{.fd = descriptor, .events = POLLIN, .revents = 0};
  while (::poll(&input, 1, kPause_ms) > 0) {
    const ssize_t count = ::read(descriptor, part.data(), part.size());
    if (count <= 0) break;
    text.append(part.data(), static_cast<std::size_t>(count));
  }
  return text;
}

std::string numbered_line(int number, std::size_t length) {
  std::string line = fmt::format("{} ", number);
  line.resize(length - 1, '.');
  return line + "\n";
}

/// The numbers of the whole lines in a text.
std::vector<int> numbers_of_lines(const std::string& text, std::size_t length) {
  std::vector<int> numbers;
  std::string line;
  for (const char letter : text) {
    if (letter == '\r') continue;  // a terminal ends its lines so
    line += letter;
    if (letter != '\n') continue;
    numbers.push_back(std::atoi(line.c_str()));
    EXPECT_EQ(line, numbered_line(numbers.back(), length)) << "is no whole line";
    line.clear();
  }
  return numbers;
}

TEST(LineOutput, ALineIsInThePipeWhenTheCallReturns) {
  Ends ends;
  open_small_pipe(ends);
  LineOutput output({}, ends.theirs);
  for (int k = 0; k < 3; ++k) {
    output.write(numbered_line(k, 100));
    output.write("");
    std::array<char, 200> text{};
    ASSERT_EQ(::read(ends.ours, text.data(), text.size()), 100);
    EXPECT_EQ(std::string(text.data(), 100), numbered_line(k, 100));
  }
  output.finish();
  EXPECT_EQ(output.dropped(), 0U);
}

// gdtslam live --queue 1 with a reader that took a part of a line: the one that waits is dropped, not the one begun.
TEST(LineOutput, WhereOneLineMayWaitTheOneThatIsBegunStays) {
  const Alarm alarm;
  constexpr std::size_t kLength = 3 * std::size_t{PIPE_BUF};
  Ends ends;
  open_small_pipe(ends);
  LineOutput output({.most_waiting = 1}, ends.theirs);
  for (int k = 0; k < 4; ++k) output.write(numbered_line(k, kLength));
  EXPECT_EQ(output.dropped(), 2U);
  EXPECT_THAT(numbers_of_lines(read_from(ends.ours), kLength), ElementsAre(0, 3));
  output.finish();
  EXPECT_EQ(output.dropped(), 2U);
}

TEST(LineOutput, WhereNoneMayWaitTheLastOneDoes) {
  const Alarm alarm;
  constexpr std::size_t kLength = PIPE_BUF;
  Ends ends;
  open_small_pipe(ends);
  LineOutput output({.most_waiting = 0}, ends.theirs);
  for (int k = 0; k < 4; ++k) output.write(numbered_line(k, kLength));
  EXPECT_THAT(numbers_of_lines(read_from(ends.ours), kLength), ElementsAre(0, 3));
  output.finish();
  EXPECT_EQ(output.dropped(), 2U);
}

// docs/threats.md: a reader that takes none does not stop the map. A terminal says that it can be written while there
// is room for one byte, and makes whoever writes more wait; it holds on to the end of the drive, too.
void expect_no_wait_for_reader_of(void (*open_ends)(Ends&)) {
  const Alarm alarm;
  constexpr int kLines = 3000;
  constexpr std::size_t kLength = 701;
  Ends ends;
  open_ends(ends);
  LineOutput output({.most_waiting = 4}, ends.theirs);
  output.write(numbered_line(0, kLength));
  EXPECT_THAT(numbers_of_lines(read_from(ends.ours), kLength), ElementsAre(0));
  for (int k = 1; k < kLines; ++k) output.write(numbered_line(k, kLength));
  output.finish();
  EXPECT_FALSE(output.has_failed());
  const std::size_t written = kLines - output.dropped();
  const std::vector<int> numbers = numbers_of_lines(read_from(ends.ours), kLength);
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
  EXPECT_THAT(numbers.size() + 1, AnyOf(written, written + 1)) << "a line that waits in the system comes out now";
  EXPECT_THAT(written, AllOf(Gt(1U), Lt(1000U))) << "until all was full";
}

TEST(LineOutput, APipeThatNobodyReadsStopsNobody) { expect_no_wait_for_reader_of(open_small_pipe); }
TEST(LineOutput, ASocketThatNobodyReadsStopsNobody) { expect_no_wait_for_reader_of(open_small_socket); }
TEST(LineOutput, ATerminalThatNobodyReadsStopsNobody) { expect_no_wait_for_reader_of(open_terminal); }

TEST(LineOutput, ATerminalThatIsReadGetsEachLine) {
  const Alarm alarm;
  constexpr std::size_t kLength = 150;
  Ends ends;
  open_terminal(ends);
  LineOutput output({.most_waiting = 100}, ends.theirs);
  std::vector<int> expected;
  for (int k = 0; k < 20; ++k) {
    output.write(numbered_line(k, kLength));
    expected.push_back(k);
  }
  EXPECT_EQ(numbers_of_lines(read_from(ends.ours), kLength), expected);
  output.finish();
  EXPECT_EQ(output.dropped(), 0U);
}

TEST(LineOutput, ADeviceThatIsFullIsToldAtTheEndAndAReaderThatIsGoneIsNot) {
  const int full = ::open("/dev/full", O_WRONLY);
  ASSERT_GE(full, 0);
  LineOutput output({}, full);
  output.write("1\n");
  EXPECT_TRUE(output.has_failed());
  EXPECT_THROW(output.finish(), FileError);
  ::close(full);
  Ends ends;
  open_small_socket(ends);
  ::shutdown(ends.ours, SHUT_RDWR);
  LineOutput other({}, ends.theirs);
  other.write("1\n");
  other.finish();
  EXPECT_FALSE(other.has_failed());
}

// Of a drive that goes on: the mapping thread and that of snapshots both say things to a terminal that hangs.
TEST(Remarks, ATerminalThatNobodyReadsStopsNobody) {
  const Alarm alarm;
  Ends ends;
  open_terminal(ends);
  {
    const Remarks remarks(ends.theirs);
    const auto say = [](const std::string& who) {
      for (int k = 0; k < 100; ++k) print_remark(who + std::string(700, '.'));
    };
    std::thread other([&say] { say("snapshots"); });
    say("mapping");
    other.join();
    print_error("the last words");
  }
  EXPECT_THAT(read_from(ends.ours), StartsWith("gdtslam: "));
}

TEST(Remarks, APipeThatIsReadGetsEachLineInOrder) {
  const Alarm alarm;
  Ends ends;
  open_small_pipe(ends);
  std::string expected;
  std::string text;
  std::thread reader([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    while (text.find("a\\nb") == std::string::npos) text += read_from(ends.ours);
  });
  {
    const Remarks remarks(ends.theirs);
    for (int k = 0; k < 500; ++k) {
      print_remark(fmt::format("{}", k));
      expected += fmt::format("gdtslam: {}\n", k);
    }
    print_error("a\nb");
    expected += "gdtslam: error: a\\nb\n";
  }
  reader.join();
  EXPECT_EQ(text, expected);
}

// Each line is tried: room may come back. A reader that went away takes none, and nobody waits for it.
TEST(Remarks, ALineThatCannotBeWrittenSilencesNoOther) {
  const std::string path = testing::TempDir() + "/remarks_" + std::to_string(::getpid());
  const int file = ::open(path.c_str(), O_CREAT | O_TRUNC | O_RDWR, 0600);
  ASSERT_GE(file, 0);
  const int full = ::open("/dev/full", O_WRONLY);
  const int used = ::dup(full);
  {
    const Remarks remarks(used);
    print_remark("1");
    ::dup2(file, used);  // there is room now
    print_remark("2");
  }
  std::string text(64, '\0');
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, ::pread(file, text.data(), text.size(), 0))));
  EXPECT_EQ(text, "gdtslam: 2\n");
  for (const int descriptor : {file, full, used}) ::close(descriptor);
  ::unlink(path.c_str());
}

TEST(Remarks, ADeviceThatIsFullIsNoError) {
  const int full = ::open("/dev/full", O_WRONLY);
  ASSERT_GE(full, 0);
  {
    const Remarks remarks(full);
    print_remark("1");
  }
  ::close(full);
}

}  // namespace
}  // namespace gdtslam
