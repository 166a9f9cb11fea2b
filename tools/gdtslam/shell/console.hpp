// Output of a command, and the signals that end it. Results go to standard output, and a failed write is an error (exit
// 74), so a full disk does not pass for success. Remarks, errors and progress go to standard error, one line each.
// Names of files, logs and options can come from strangers: control characters, marks that change the direction of text
// and invalid UTF-8 are shown as \x1b and the like, so no text can add a line to a message, reorder it or control a
// terminal.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace gdtslam {

/// Writes text to standard output, line ends and tabs unchanged, and flushes. False if the reader is gone. Throws
/// FileError.
bool print_result(std::string_view text);

/// Writes "gdtslam: <text>" and a line end to standard error.
void print_remark(std::string_view text);

/// Writes "gdtslam: error: <text>" and a line end to standard error.
void print_error(std::string_view text);

/// The text as valid UTF-8 without control characters other than those in `kept`.
std::string printable(std::string_view text, std::string_view kept = "");

/// "1 scan", "2884 scans".
std::string plural(std::uint64_t count, std::string_view noun);

// Turns SIGINT, SIGTERM and SIGHUP into a flag that loops check. The first signal lets the current step finish and ends
// a blocked read of standard input; a second SIGINT or SIGTERM ends the process. SIGPIPE and SIGXFSZ are ignored: a
// closed reader and a file beyond its size limit show as failed writes. Async-signal-safe.

/// Occupies the descriptors of standard input, output and error if they are closed, so that no file opened later gets
/// one of them and receives printed text. Reading and writing them fails as on a closed descriptor. Call it first.
void hold_standard_streams();

/// Installs the handlers; call once, before any thread starts.
void install_interrupt_handlers();

/// Whether one of the three signals came.
bool interrupted();

// A progress line on standard error. It is drawn only on a terminal and at most ten times a second, so pipes and logs
// stay clean. A line belongs to one thread.

/// "3 s", "1:40 min", "2:45 h": rounded up, at least zero.
std::string time_left_text(double seconds);

/// A line with any text.
class TerminalLine {
 public:
  /// Draws nothing if `quiet`.
  explicit TerminalLine(bool quiet);
  TerminalLine(const TerminalLine&) = delete;
  TerminalLine& operator=(const TerminalLine&) = delete;
  ~TerminalLine();

  /// Draws at most ten times a second; `text` is called only then.
  void draw(const std::function<std::string(double elapsed_s)>& text);
  /// Draws at once, for events that are rare and may last.
  void draw_now(std::string_view text);
  /// Wipes the line; the destructor does so too.
  void clear();
  /// Seconds since construction.
  [[nodiscard]] double elapsed_s() const;

 private:
  using Clock = std::chrono::steady_clock;
  bool enabled_;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point last_;
};

/// Line with the share done, things per second, time left.
class ProgressLine {
 public:
  /// `unit` names the things counted, for example "scans"; nothing is drawn if `quiet`.
  ProgressLine(std::string unit, bool quiet);

  /// `share` is 0 to 1, negative if unknown.
  void update(std::uint64_t count, double share);
  void clear() { line_.clear(); }

  /// Text that update() draws, for tests: "  42 %  5,730 scans  2,880/s  3 s left".
  static std::string text(const std::string& unit, std::uint64_t count, double share, double elapsed_s);

 private:
  std::string unit_;
  TerminalLine line_;
};

// Clouds in a national grid are read relative to whole kilometres; commands that print or draw places report the
// offset.

std::string origin_text(const std::string& cloud, const std::array<double, 3>& origin_m);

/// Prints a line on standard error if the origin is not zero.
void remark_origin(const std::string& cloud, const std::array<double, 3>& origin_m);

}  // namespace gdtslam
