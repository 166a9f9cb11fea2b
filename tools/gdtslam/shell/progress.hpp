// One line on standard error that says how far a run is. It is drawn only when standard error is a terminal, at most
// ten times a second, so that pipes and logs stay clean. A line belongs to one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace gdtslam {

/// "3 s", "1:40 min", "2:45 h": rounded up, nothing below zero.
std::string time_left_text(double seconds);

/// The line itself, whatever it says.
class TerminalLine {
 public:
  /// Nothing is ever drawn when `quiet`.
  explicit TerminalLine(bool quiet);
  TerminalLine(const TerminalLine&) = delete;
  TerminalLine& operator=(const TerminalLine&) = delete;
  ~TerminalLine();

  /// Asks for the text only when it is time to draw again.
  void draw(const std::function<std::string(double elapsed_s)>& text);
  /// Wipes the line; also done at the end of its life.
  void clear();
  /// Since it was made.
  [[nodiscard]] double elapsed_s() const;

 private:
  using Clock = std::chrono::steady_clock;
  bool enabled_;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point last_;
};

/// Share done, things a second, time left.
class ProgressLine {
 public:
  /// `unit` is what is counted, for example "scans"; nothing is ever drawn when `quiet`.
  ProgressLine(std::string unit, bool quiet);

  /// `share` is 0 to 1, negative when unknown.
  void update(std::uint64_t count, double share);
  void clear() { line_.clear(); }

  /// "  42 %  5,730 scans  2,880/s  3 s left": what update() draws; apart, to be tested.
  static std::string text(const std::string& unit, std::uint64_t count, double share, double elapsed_s);

 private:
  std::string unit_;
  TerminalLine line_;
};

}  // namespace gdtslam
