// Output of a command, and the signals that end it. Results go to standard output and a write that fails is an error
// (exit 74), so that a full disk or a reader that went away does not pass for success; remarks, errors and progress go
// to standard error, a line each. Names of files, logs and options can come from strangers: control characters, marks
// that change the direction of text and invalid UTF-8 are shown as \x1b and the like, so that no text can add a line to
// a message, reorder it or give an order to a terminal.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace gdtslam {

/// Writes text to standard output, line ends and tabs as they are, and flushes. False where nobody reads it any more.
/// Throws FileError.
bool print_result(std::string_view text);

/// Writes "gdtslam: <text>" and a line end to standard error.
void print_remark(std::string_view text);

/// Writes "gdtslam: error: <text>" and a line end to standard error.
void print_error(std::string_view text);

/// The text without control characters, save those of `kept`, and in valid UTF-8.
std::string printable(std::string_view text, std::string_view kept = "");

/// "1 scan", "2884 scans".
std::string plural(std::uint64_t count, std::string_view noun);

// SIGINT, SIGTERM and SIGHUP as a flag that loops look at. The first signal lets the step in hand finish and ends the
// input of a program that waits for its standard input; a second SIGINT or SIGTERM ends the process. SIGPIPE and
// SIGXFSZ are ignored: a reader that goes away and a file that grows beyond its limit show as failed writes.
// Async-signal-safe.

/// Takes the numbers of standard input, output and error where they are closed, so that no file which is opened later
/// gets one of them and what is printed lands in it. Reading and writing them fails as it does on a closed one. Call it
/// first.
void hold_standard_streams();

/// Installs the handlers; call once, before any thread starts.
void install_interrupt_handlers();

/// True once one of the three came.
bool interrupted();

// One line on standard error that says how far a run is. It is drawn only when standard error is a terminal, at most
// ten times a second, so that pipes and logs stay clean. A line belongs to one thread.

/// "3 s", "1:40 min", "2:45 h": rounded up, nothing below zero.
std::string time_left_text(double seconds);

/// The line itself, whatever it says.
class TerminalLine {
 public:
  /// Draws nothing when `quiet`.
  explicit TerminalLine(bool quiet);
  TerminalLine(const TerminalLine&) = delete;
  TerminalLine& operator=(const TerminalLine&) = delete;
  ~TerminalLine();

  /// Asks for the text only when it is time to draw again.
  void draw(const std::function<std::string(double elapsed_s)>& text);
  /// Draws whatever was drawn last and when: for what happens seldom and may last.
  void draw_now(std::string_view text);
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

// Clouds in a country's grid are read relative to whole kilometres; who prints or draws places says so.

std::string origin_text(const std::string& cloud, const std::array<double, 3>& origin_m);

/// One line on standard error where something was taken off.
void remark_origin(const std::string& cloud, const std::array<double, 3>& origin_m);

}  // namespace gdtslam
