#include "console.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <functional>
#include <mutex>
#include <utility>

#include "engine/core/files/interruption.hpp"
#include "engine/drawing/letters.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam {
namespace {

// C0, DEL, C1, the two separators that some programs show as line ends, and Unicode's marks that change the direction
// of text, which would reorder the line around them.
bool is_control(char32_t code) {
  const auto is_within = [code](char32_t first, char32_t last) { return code >= first && code <= last; };
  return is_within(0, 0x1FU) || is_within(0x7FU, 0x9FU) || is_within(0x2028U, 0x202EU) || is_within(0x2066U, 0x2069U) ||
         is_within(0x200EU, 0x200FU) || code == 0x061CU;
}

std::mutex g_lines_mutex;

void print_line(const char* begin, std::string_view text) {
  const std::string line = fmt::format("{}{}\n", begin, printable(text));
  const std::lock_guard lock(g_lines_mutex);
  std::fputs(line.c_str(), stderr);  // a lost terminal is ignored
  std::fflush(stderr);
}

std::atomic<bool> g_interrupted{false};  // read by other threads than the interrupted one
int g_empty_input = -1;

constexpr std::int64_t kOneAsk_ns = 100'000'000;
std::array<std::atomic<std::int64_t>, 2> g_asked_ns{};  // by SIGINT, by another signal; 0: not yet
static_assert(std::atomic<std::int64_t>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal handler sets them");

std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

// The second signal of a kind gets its default effect when the handler returns, unless it repeats the first one:
// timeout(1) signals the process and then its group. A lost terminal causes two SIGHUPs, from the kernel and from the
// shell, so the second must not end the process.
void end_if_asked_twice(int signal) {
  if (signal == SIGHUP) return;
  std::atomic<std::int64_t>& asked_ns = g_asked_ns[signal == SIGINT ? 0 : 1];
  const std::int64_t now_ns = monotonic_ns();
  if (asked_ns == 0) {
    asked_ns = now_ns;
  } else if (now_ns - asked_ns > kOneAsk_ns) {
    std::signal(signal, SIG_DFL);
    ::raise(signal);
  }
}

// A blocked read of standard input returns, is repeated and then finds the end of the file.
extern "C" void on_interrupt(int signal) {
  const int saved_errno = errno;
  end_if_asked_twice(signal);
  g_interrupted = true;
  if (g_empty_input >= 0) ::dup2(g_empty_input, STDIN_FILENO);
  errno = saved_errno;
}

constexpr std::chrono::milliseconds kRedrawInterval{100};
constexpr double kLongestShown_s = 100.0 * 3600.0;

// A lost terminal is ignored, and the work continues without it.
void write_line(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace

std::string printable(std::string_view text, std::string_view kept) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Letter letter = next_letter(text, at);
    const bool is_broken = letter.code == kUnknownLetter && letter.bytes != kUnknownLetterBytes;
    if (kept.find(letter.bytes) != std::string_view::npos || !(is_control(letter.code) || is_broken)) {
      shown += letter.bytes;
    } else if (letter.bytes == "\n") {
      shown += "\\n";
    } else {
      for (const char byte : letter.bytes) shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
    }
  }
  return shown;
}

bool print_result(std::string_view text) {
  const std::string shown = printable(text, "\n\t");
  errno = 0;
  if (std::fwrite(shown.data(), 1, shown.size(), stdout) != shown.size() || std::fflush(stdout) != 0) {
    // The reader is gone, like `head`, or its terminal is.
    if (errno == EPIPE || (errno == EIO && interrupted())) return false;
    throw FileError("standard output", "cannot be written: " + errno_text(errno));
  }
  return true;
}

std::string plural(std::uint64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

void print_remark(std::string_view text) { print_line("gdtslam: ", text); }

void print_error(std::string_view text) { print_line("gdtslam: error: ", text); }

void hold_standard_streams() {
  // The lowest free number is taken, so each closed stream gets its place. A path alone (O_PATH) can be neither read
  // nor written, the root always exists, and child programs inherit it like a closed stream.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) == -1 && errno == EBADF) ::open("/", O_PATH);  // NOLINT(android-cloexec-open)
  }
}

void install_interrupt_handlers() {
  asked_to_end = interrupted;
  g_empty_input = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  action.sa_flags = 0;  // no SA_RESTART
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  // A process started with nohup ignores it.
  struct sigaction inherited {};
  if (::sigaction(SIGHUP, nullptr, &inherited) == 0 && inherited.sa_handler != SIG_IGN) {
    ::sigaction(SIGHUP, &action, nullptr);
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupted() { return g_interrupted; }

std::string time_left_text(double seconds) {
  const auto whole = static_cast<std::uint64_t>(std::ceil(std::max(seconds, 0.0)));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

TerminalLine::TerminalLine(bool quiet)
    : enabled_(!quiet && ::isatty(STDERR_FILENO) == 1), start_(Clock::now()), last_(start_) {}

TerminalLine::~TerminalLine() { clear(); }

void TerminalLine::draw(const std::function<std::string(double elapsed_s)>& text) {
  if (!enabled_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_ < kRedrawInterval) return;
  last_ = now;
  drawn_ = true;
  write_line("\r\x1b[K" + printable(text(elapsed_s())));
}

void TerminalLine::draw_now(std::string_view text) {
  if (!enabled_) return;
  last_ = Clock::now();
  drawn_ = true;
  write_line("\r\x1b[K" + printable(text));
}

double TerminalLine::elapsed_s() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

void TerminalLine::clear() {
  if (!drawn_) return;
  drawn_ = false;
  write_line("\r\x1b[K");
}

ProgressLine::ProgressLine(std::string unit, bool quiet) : unit_(std::move(unit)), line_(quiet) {}

std::string ProgressLine::text(const std::string& unit, std::uint64_t count, double share, double elapsed_s) {
  std::string line;
  if (share >= 0.0) line += fmt::format("{:3.0f} %  ", 100.0 * share);
  line += fmt::format("{} {}", with_commas(count), unit);
  if (elapsed_s > 0.0) {
    line += fmt::format("  {}/s", with_commas(static_cast<std::uint64_t>(static_cast<double>(count) / elapsed_s)));
  }
  if (share > 0.0 && share <= 1.0) {
    const double left_s = elapsed_s * (1.0 - share) / share;
    if (left_s < kLongestShown_s) line += fmt::format("  {} left", time_left_text(left_s));
  }
  return line;
}

void ProgressLine::update(std::uint64_t count, double share) {
  line_.draw([&](double elapsed_s) { return text(unit_, count, share, elapsed_s); });
}

std::string origin_text(const std::string& cloud, const std::array<double, 3>& origin_m) {
  return fmt::format("{} lies far from its origin: places are relative to ({:.0f}, {:.0f}, {:.0f}) m", cloud,
                     origin_m[0], origin_m[1], origin_m[2]);
}

void remark_origin(const std::string& cloud, const std::array<double, 3>& origin_m) {
  if (origin_m != std::array<double, 3>{}) print_remark(origin_text(cloud, origin_m));
}

}  // namespace gdtslam
