#include "carmen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "carmen_line.hpp"
#include "engine/io/decimal.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/tables/foreign_file.hpp"
#include "engine/io/text_log.hpp"
#include "gdtslam/core/error.hpp"
#include "steady_mount.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kBinaryProbeBytes = 4096;
constexpr std::size_t kMostKindShown = 40;
constexpr std::string_view kLineBlanks = " \t\r";
constexpr double kFarMountM = 3.0;  // farther than a laser sits on any robot of these logs

class CarmenReader final : public TextLog {
 public:
  CarmenReader(std::unique_ptr<ByteSource> source, std::string name, const ReadOptions& options)
      : TextLog("CARMEN", std::move(source), std::move(name), options) {
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
        ++records_;
        return record;
      }
    }
    finish(fmt::format("holds no complete CARMEN message in {} lines{}", last_line_, give_a_log()));
    return std::nullopt;
  }

 private:
  std::optional<LogRecord> record_of(const TextLine& line) {
    if (!is_begun_) look_at_start(line);
    try {
      if (line.is_too_long) throw MalformedLine(fmt::format("is longer than {} bytes", kMaxLogLineBytes));
      CarmenLine parsed = parse_carmen_line(without_byte_order_mark(line), options_);
      if (!line.has_newline && (!parsed.is_whole || !parsed.skipped_kind.empty())) {
        warn("cut last line", "its end may be missing, so it is dropped");
        return std::nullopt;
      }
      count(line.text, parsed);
      note(parsed);
      return std::move(parsed.record);
    } catch (const MalformedLine& error) {
      const std::string_view kind = line.text.substr(0, line.text.find_first_of(" \t\r"));
      refuse(line, "the line " + in_quotes(kind), error.what());
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

  void note(CarmenLine& line) {
    if (!line.skipped_kind.empty()) {
      warn(fmt::format("skipped message {}", line.skipped_kind), "this message kind is not read");
    } else if (line.record) {
      if (auto* scan = std::get_if<ScanRecord>(&*line.record)) {
        note_repairs(line.repairs);
        if (!options_.T_base_laser) {
          scan->scan.T_base_laser = mounts_[scan->laser].of(scan->scan.T_base_laser, line.pose_decimals);
        }
        note_carmen_scan(*scan);
      } else if (const auto* parameter = std::get_if<Parameter>(&*line.record)) {
        note_parameter(*parameter);
      }
    }
  }

  void note_carmen_scan(ScanRecord& record) {
    LaserScan& scan = record.scan;
    if (scan.max_range_m == 0.0) {
      scan.max_range_m = stated_max_range_m_;
    }
    note_scan(record);
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

  std::array<SteadyMount, 2> mounts_;  ///< of each laser
  double stated_max_range_m_ = 0.0;
  bool is_begun_ = false;
};

}  // namespace

std::unique_ptr<DescribedLog> open_carmen(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                          const ReadOptions& options) {
  return std::make_unique<CarmenReader>(std::move(unpacked), name, options);
}

}  // namespace gdtslam
