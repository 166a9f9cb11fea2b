#include "reproduce_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "console.hpp"

namespace gdtslam::reproduce {
namespace {

constexpr std::chrono::milliseconds kRedrawInterval{200};
// Of what is done before its speed tells more than the weights do.
constexpr double kTelling_s = 2.0;

std::string duration_text(double seconds) {
  const auto whole = static_cast<std::uint64_t>(std::ceil(std::max(seconds, 0.0)));
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

}  // namespace

Progress::Progress(std::size_t parts, double total_s, bool quiet)
    : parts_(parts),
      total_s_(total_s),
      quiet_(quiet),
      is_terminal_(::isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_(start_ - kRedrawInterval) {}

Progress::~Progress() { clear(); }

void Progress::begin(const std::string& label, double weight_s) {
  ++number_;
  label_ = label;
  weight_s_ = weight_s;
  update(0.0);
}

std::string Progress::text(const std::string& label, std::size_t number, std::size_t parts, double share, double left) {
  return fmt::format("{} ({} of {})  {:.0f} %  {} left", label, number, parts, 100.0 * share, duration_text(left));
}

double Progress::left_s(double share) const {
  const double done_s = done_s_ + share * weight_s_;
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - start_).count();
  const double pace = done_s > kTelling_s ? elapsed_s / done_s : 1.0;
  return pace * std::max(0.0, total_s_ - done_s);
}

void Progress::update(double share) {
  if (quiet_ || !is_terminal_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_ < kRedrawInterval) return;
  last_ = now;
  drawn_ = true;
  const double known = std::clamp(share, 0.0, 1.0);
  fmt::print(stderr, "\r\x1b[K{}", text(label_, number_, parts_, known, left_s(known)));
  std::fflush(stderr);
}

void Progress::finish(double seconds) {
  done_s_ += weight_s_;
  weight_s_ = 0.0;
  clear();
  if (quiet_) return;
  const double left = left_s(0.0);
  print_remark(fmt::format("{} made in {:.1f} s ({} of {}{})", label_, seconds, number_, parts_,
                           number_ < parts_ ? fmt::format(", about {} left", duration_text(left)) : ""));
}

void Progress::clear() {
  if (!drawn_) return;
  drawn_ = false;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
}

}  // namespace gdtslam::reproduce
