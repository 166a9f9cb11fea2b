#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "console.hpp"

namespace gdtslam {
namespace {

constexpr std::chrono::milliseconds kRedrawInterval{100};
constexpr double kLongestShown_s = 100.0 * 3600.0;

std::string with_thousands(std::uint64_t value) {
  const std::string digits = std::to_string(value);
  std::string text;
  for (std::size_t k = 0; k < digits.size(); ++k) {
    if (k > 0 && (digits.size() - k) % 3 == 0) text += ',';
    text += digits[k];
  }
  return text;
}

// A terminal that has gone away takes no more, and the work goes on without it.
void write_line(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace

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
  line += fmt::format("{} {}", with_thousands(count), unit);
  if (elapsed_s > 0.0) {
    line += fmt::format("  {}/s", with_thousands(static_cast<std::uint64_t>(static_cast<double>(count) / elapsed_s)));
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

}  // namespace gdtslam
