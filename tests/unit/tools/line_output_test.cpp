// Lines for readers that take none: pipes, sockets and terminals that are full. An alarm ends a test that hangs.
#include "tools/gdtslam/live/output/line_output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::Lt;

/// What is written to `theirs` can be read from `ours`.
class LineOutputTest : public testing::Test {
 protected:
  LineOutputTest() {
    ::alarm(100);
    std::signal(SIGPIPE, SIG_IGN);  // as the command has it
  }
  ~LineOutputTest() override {
    ::alarm(0);
    ::close(ours_);
    ::close(theirs_);
  }

  void open_small_pipe() {
    std::array<int, 2> both{};
    ASSERT_EQ(::pipe(both.data()), 0);
    ours_ = both[0];
    theirs_ = both[1];
    ASSERT_EQ(::fcntl(theirs_, F_SETPIPE_SZ, PIPE_BUF), PIPE_BUF);
  }
  void open_terminal() {
    ours_ = ::posix_openpt(O_RDWR | O_NOCTTY);
    ASSERT_GE(ours_, 0);
    ASSERT_EQ(::grantpt(ours_), 0);
    ASSERT_EQ(::unlockpt(ours_), 0);
    std::array<char, 64> name{};
    ASSERT_EQ(::ptsname_r(ours_, name.data(), name.size()), 0);
    theirs_ = ::open(name.data(), O_RDWR | O_NOCTTY);
    ASSERT_GE(theirs_, 0);
  }
  /// What is there, and what comes within a fifth of a second.
  [[nodiscard]] std::string read_all() const {
    constexpr int kPause_ms = 200;
    std::string text;
    std::array<char, PIPE_BUF> part{};
    pollfd input{.fd = ours_, .events = POLLIN, .revents = 0};
    while (::poll(&input, 1, kPause_ms) > 0) {
      const ssize_t count = ::read(ours_, part.data(), part.size());
      if (count <= 0) break;
      text.append(part.data(), static_cast<std::size_t>(count));
    }
    return text;
  }
  void expect_no_wait_for_reader() const;

  int ours_ = -1;
  int theirs_ = -1;
};

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

TEST_F(LineOutputTest, AReaderThatReadsGetsEachLineInOrder) {
  constexpr std::size_t kLength = 100;
  open_small_pipe();
  LineOutput output({}, theirs_);
  for (int k = 0; k < 3; ++k) output.write(numbered_line(k, kLength));
  output.write("");
  output.finish();
  EXPECT_THAT(numbers_of_lines(read_all(), kLength), ElementsAre(0, 1, 2));
  EXPECT_EQ(output.dropped(), 0U);
}

// gdtslam live --queue 1 with a reader that took a part of a line: the one that waits is dropped, not the one begun.
TEST_F(LineOutputTest, IfOneLineMayWaitTheOneThatIsBegunStays) {
  constexpr std::size_t kLength = 3 * std::size_t{PIPE_BUF};
  open_small_pipe();
  LineOutput output({.most_waiting = 1}, theirs_);
  output.write(numbered_line(0, kLength));
  pollfd begun{.fd = ours_, .events = POLLIN, .revents = 0};
  ASSERT_EQ(::poll(&begun, 1, -1), 1);
  for (int k = 1; k < 4; ++k) output.write(numbered_line(k, kLength));
  EXPECT_THAT(numbers_of_lines(read_all(), kLength), ElementsAre(0, 3));
  output.finish();
  EXPECT_EQ(output.dropped(), 2U);
}

// docs/threats.md: a reader that takes none does not stop the map, nor the end of the drive.
void LineOutputTest::expect_no_wait_for_reader() const {
  constexpr int kLines = 3000;
  constexpr std::size_t kLength = 701;
  LineOutput output({.most_waiting = 4}, theirs_);
  for (int k = 0; k < kLines; ++k) output.write(numbered_line(k, kLength));
  output.finish();
  EXPECT_FALSE(output.has_failed());
  EXPECT_THAT(output.dropped(), AllOf(Gt(2000U), Lt(kLines - 1U)));
  const std::vector<int> numbers = numbers_of_lines(read_all(), kLength);
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
}

TEST_F(LineOutputTest, APipeThatNobodyReadsStopsNobody) {
  open_small_pipe();
  expect_no_wait_for_reader();
}

TEST_F(LineOutputTest, ATerminalThatNobodyReadsStopsNobody) {
  open_terminal();
  expect_no_wait_for_reader();
}

TEST_F(LineOutputTest, ADeviceThatIsFullIsToldAtTheEndAndAReaderThatIsGoneIsNot) {
  theirs_ = ::open("/dev/full", O_WRONLY);
  ASSERT_GE(theirs_, 0);
  LineOutput output({}, theirs_);
  output.write("1\n");
  EXPECT_THROW(output.finish(), FileError);
  EXPECT_TRUE(output.has_failed());
  ::close(theirs_);
  open_small_pipe();
  ::close(ours_);
  LineOutput other({}, theirs_);
  other.write("1\n");
  other.finish();
  EXPECT_FALSE(other.has_failed());
}

}  // namespace
}  // namespace gdtslam
