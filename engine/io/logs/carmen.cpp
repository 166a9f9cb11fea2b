#include "carmen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "carmen_line.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/decimal.hpp"
#include "engine/io/line_reader.hpp"
#include "engine/io/log_contents.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/scan_sequence.hpp"
#include "engine/io/tables/foreign_file.hpp"
#include "engine/io/unpack_source.hpp"
#include "engine/io/warning_counter.hpp"
#include "gdtslam/core/error.hpp"
#include "steady_mount.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kBinaryProbeBytes = 4096;
constexpr std::size_t kMostKindShown = 40;
constexpr std::string_view kLineBlanks = " \t\r";
constexpr double kFarMountM = 3.0;  // farther than a laser sits on any robot of these logs

class CarmenReader final : public DescribedLog {
 public:
  CarmenReader(std::unique_ptr<ByteSource> source, std::string name, const ReadOptions& options)
      : name_(std::move(name)), options_(options), lines_(std::move(source), kMaxLogLineBytes) {
    const std::string_view head = lines_.peek(kBinaryProbeBytes);
    if (head.empty()) {
      throw InputError({name_, 0}, "is empty" + give_a_log());
    }
    // Of a pipe more than a line may have come or not, and that must make no difference.
    const std::string_view first = head.substr(0, head.find('\n'));
    if (const std::string fault = fault_of_foreign_line(first); !fault.empty()) throw InputError({name_, 0}, fault);
    if (first.find('\0') != std::string_view::npos) {
      throw InputError({name_, 0}, "holds binary data" + give_a_log());
    }
  }

  std::optional<LogRecord> next() override {
    while (const std::optional<TextLine> line = next_line()) {
      if (std::optional<LogRecord> record = record_of(*line)) {
        ++record_count_;
        return record;
      }
    }
    finish();
    return std::nullopt;
  }
  [[nodiscard]] double progress() const override { return lines_.source().progress(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const override { return warnings_.list(); }
  [[nodiscard]] LogContents contents() const override {
    LogContents contents;
    contents.format = "CARMEN";
    contents.lines = kinds_.list();
    return contents;
  }

 private:
  std::optional<TextLine> next_line() {
    last_line_ = lines_.skip_empty_lines();
    return lines_.next();
  }

  std::optional<LogRecord> record_of(const TextLine& line) {
    last_line_ = line.number;
    if (!is_begun_) look_at_start(line);
    if (line.is_too_long) {
      refuse(line, fmt::format("is longer than {} bytes", kMaxLogLineBytes));
      return std::nullopt;
    }
    try {
      CarmenLine parsed = parse_carmen_line(without_byte_order_mark(line), options_);
      if (!line.has_newline && (!parsed.is_whole || !parsed.skipped_kind.empty())) {
        warn("cut last line", "its end may be missing, so it is dropped");
        return std::nullopt;
      }
      count(line.text, parsed);
      note(parsed);
      return std::move(parsed.record);
    } catch (const MalformedLine& error) {
      refuse(line, error.what());
      return std::nullopt;
    }
  }

  /// Up to the first line that is no comment.
  void look_at_start(const TextLine& line) {
    const std::string_view text = without_byte_order_mark(line);
    if (const std::string fault = fault_of_foreign_line(text); !fault.empty()) throw InputError({name_, 0}, fault);
    is_begun_ = !text.empty() && text.front() != '#';
  }

  void count(std::string_view text, const CarmenLine& parsed) {
    if (!parsed.record && parsed.skipped_kind.empty()) return;  // a comment, or nothing
    text.remove_prefix(std::min(text.find_first_not_of(kLineBlanks), text.size()));
    kinds_.add(one_line(text.substr(0, text.find_first_of(kLineBlanks)), kMostKindShown), parsed.record.has_value());
  }

  /// Some editors begin a text with U+FEFF.
  static std::string_view without_byte_order_mark(const TextLine& line) {
    constexpr std::string_view kMark = "\xef\xbb\xbf";
    return line.number == 1 && line.text.starts_with(kMark) ? line.text.substr(kMark.size()) : line.text;
  }

  /// A line that cannot be read: the end of a log that was cut, an error, or one to skip.
  void refuse(const TextLine& line, const std::string& reason) {
    if (!line.has_newline && !line.is_too_long) {
      warn("cut last line", reason);
    } else if (options_.lenient) {
      warn("malformed line", reason);
    } else {
      const std::string_view kind = line.text.substr(0, line.text.find_first_of(" \t\r"));
      throw InputError({name_, line.number},
                       fmt::format("the line {} {}; correct it or skip such lines with --lenient, or else "
                                   "with gdtslam convert --lenient",
                                   in_quotes(kind), reason));
    }
  }

  void note(CarmenLine& line) {
    if (!line.skipped_kind.empty()) {
      warn(fmt::format("skipped message {}", line.skipped_kind), "this message kind is not read");
    } else if (line.record) {
      if (auto* scan = std::get_if<ScanRecord>(&*line.record)) {
        note_repairs(line.repairs);
        if (!options_.T_base_laser) {
          scan->scan.T_base_laser = mounts_[scan->laser].of(scan->scan.T_base_laser, line.pose_decimals);
        }
        note_scan(*scan);
      } else if (const auto* parameter = std::get_if<Parameter>(&*line.record)) {
        note_parameter(*parameter);
      }
    }
  }

  void note_repairs(const RangeRepairs& repairs) {
    if (repairs.not_a_number > 0) {
      warn("range not a number", "taken as no return", repairs.not_a_number);
    }
    if (repairs.negative > 0) {
      warn("negative range", "taken as no return", repairs.negative);
    }
  }

  void note_scan(ScanRecord& record) {
    LaserScan& scan = record.scan;
    if (scan.max_range_m == 0.0) {
      scan.max_range_m = stated_max_range_m_;
    }
    sequences_[record.laser].check(scan,
                                   [this](std::string_view kind, std::string_view detail) { warn(kind, detail); });
    if (scan.T_base_laser.translation().norm() > kFarMountM) {
      warn("laser far from robot",
           "the laser pose of the line may be corrected, not odometry; state the mount (log.mount)");
    }
  }

  /// CARMEN's own name for the limit of the front laser.
  void note_parameter(const Parameter& parameter) {
    if (parameter.name == "robot_front_laser_max") {
      double value = 0.0;
      const char* const end = parameter.value.data() + parameter.value.size();
      const char* const stop = parse_double(parameter.value.data(), end, value);
      if (stop == end && value > 0.0 && std::isfinite(value)) {
        stated_max_range_m_ = value;
      } else {
        warn("unusable parameter", "robot_front_laser_max is no range");
      }
    }
  }

  void finish() {
    if (finished_) {
      return;
    }
    finished_ = true;
    const std::string defect = lines_.source().defect();
    if (!defect.empty()) {
      warn(defect_kind(defect), defect);
    }
    if (record_count_ == 0) {
      throw InputError({name_, 0},
                       fmt::format("holds no complete CARMEN message in {} lines{}", last_line_, give_a_log()));
    }
  }

  void warn(std::string_view kind, std::string_view detail, std::uint64_t count = 1) {
    if (!warnings_.add_to(kind, count)) {
      warnings_.add(kind, located({name_, last_line_}, std::string(detail)), count);
    }
  }

  std::string name_;
  ReadOptions options_;
  LineReader lines_;
  WarningCounter warnings_;
  LineCounter kinds_;
  std::array<ScanSequence, 2> sequences_;  ///< of each laser
  std::array<SteadyMount, 2> mounts_;      ///< likewise
  double stated_max_range_m_ = 0.0;
  std::uint64_t last_line_ = 0;
  std::uint64_t record_count_ = 0;
  bool is_begun_ = false;
  bool finished_ = false;
};

std::unique_ptr<DescribedLog> read_carmen(std::unique_ptr<ByteSource> source, const std::string& name,
                                          const ReadOptions& options) {
  return std::make_unique<CarmenReader>(gunzip_if_packed(std::move(source), name), name, options);
}

}  // namespace

std::unique_ptr<DescribedLog> open_carmen(const std::string& path, const ReadOptions& options) {
  return read_carmen(open_file_source(path), path == "-" ? "standard input" : path, options);
}

std::unique_ptr<DescribedLog> open_carmen(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                          const ReadOptions& options) {
  return std::make_unique<CarmenReader>(std::move(unpacked), name, options);
}

std::unique_ptr<DescribedLog> open_carmen(std::span<const std::byte> data, const std::string& name,
                                          const ReadOptions& options) {
  return read_carmen(open_memory_source(data), name, options);
}

}  // namespace gdtslam
