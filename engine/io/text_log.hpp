// Logs of text lines: warnings, handling of malformed lines, and the end of the log. One log belongs to one thread.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/io/line_reader.hpp"
#include "engine/io/log_contents.hpp"
#include "engine/io/scan_sequence.hpp"
#include "engine/io/unpack_source.hpp"
#include "engine/io/warning_counter.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

/// The longest line that is read; a longer one is malformed.
inline constexpr std::size_t kMaxLogLineBytes = std::size_t{4} << 20U;

/// The kind of a file, by its first line without comments, and what to do: "is a PNG picture, not a log; give ...".
/// Empty if the line is not known.
std::string fault_of_foreign_line(std::string_view line);

/// "; give a CARMEN, CSV, JSON lines, ROS bag or MCAP log".
std::string give_a_log();

class TextLog : public DescribedLog {
 public:
  [[nodiscard]] double progress() const override { return lines_.source().progress(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const override { return warnings_.list(); }
  [[nodiscard]] LogContents contents() const override {
    LogContents contents;
    contents.format = format_;
    contents.lines = kinds_.list();
    return contents;
  }

 protected:
  /// `format` has static storage.
  TextLog(std::string_view format, std::unique_ptr<ByteSource> source, std::string name, const ReadOptions& options)
      : name_(std::move(name)), options_(options), lines_(std::move(source), kMaxLogLineBytes), format_(format) {}

  std::optional<TextLine> next_line() {
    last_line_ = lines_.skip_empty_lines();
    const std::optional<TextLine> line = lines_.next();
    if (line) last_line_ = line->number;
    return line;
  }

  /// Removes U+FEFF, with which some editors begin a text.
  static std::string_view without_byte_order_mark(const TextLine& line) {
    constexpr std::string_view kMark = "\xef\xbb\xbf";
    return line.number == 1 && line.text.starts_with(kMark) ? line.text.substr(kMark.size()) : line.text;
  }

  void warn(std::string_view kind, std::string_view detail, std::uint64_t count = 1) {
    if (!warnings_.add_to(kind, count)) {
      warnings_.add(kind, located({name_, last_line_}, std::string(detail)), count);
    }
  }

  void note_repairs(const RangeRepairs& repairs) {
    if (repairs.not_a_number > 0) warn("range not a number", "taken as no return", repairs.not_a_number);
    if (repairs.negative > 0) warn("negative range", "taken as no return", repairs.negative);
  }

  void note_scan(const ScanRecord& record) {
    sequences_[record.laser].check(record.scan,
                                   [this](std::string_view kind, std::string_view detail) { warn(kind, detail); });
  }

  /// Handles a malformed line: the end of a cut log, an error, or a line to skip. `subject` names the line.
  void refuse(const TextLine& line, const std::string& subject, const std::string& reason) {
    if (!line.has_newline && !line.is_too_long) {
      warn("cut last line", reason);
    } else if (options_.lenient) {
      warn("malformed line", reason);
    } else {
      throw InputError({name_, line.number},
                       fmt::format("{} {}; correct it or skip such lines with --lenient, or else with gdtslam convert "
                                   "--lenient",
                                   subject, reason));
    }
  }

  /// Call after the last line; InputError with the fault if no line could be read.
  void finish(const std::string& fault_of_none) {
    if (std::exchange(is_finished_, true)) return;
    const std::string defect = lines_.source().defect();
    if (!defect.empty()) warn(defect_kind(defect), defect);
    if (records_ == 0) throw InputError({name_, 0}, fault_of_none);
  }

  // For the readers of each format.
  std::string name_;
  ReadOptions options_;
  LineReader lines_;
  LineCounter kinds_;
  std::uint64_t last_line_ = 0;
  std::uint64_t records_ = 0;

 private:
  std::string_view format_;
  WarningCounter warnings_;
  std::map<std::size_t, ScanSequence> sequences_;  ///< by laser
  bool is_finished_ = false;
};

}  // namespace gdtslam
