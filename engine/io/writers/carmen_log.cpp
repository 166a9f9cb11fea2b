#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/io/decimal.hpp"
#include "engine/io/logs/carmen_writer.hpp"
#include "engine/io/logs/gzip_file.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/angle.hpp"
#include "log_formats.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kLimitParameter = "robot_front_laser_max";

/// CARMEN only supports a step above 0.
void turn_beams_right_to_left(LaserScan& scan) {
  if (scan.ranges_m.size() < 2 && !(scan.bearing_step_rad > 0.0)) scan.bearing_step_rad = rad_from_deg(1.0);
  if (!(scan.bearing_step_rad > 0.0)) turn_beams_round(scan);
}

bool is_one_word(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c <= '~'; });
}

class CarmenLog final : public LogWriter {
 public:
  explicit CarmenLog(AtomicFile& file) : sink_(file), writer_(CarmenWriter::kAsNeeded, "gdtslam") {}
  bool write(const LogRecord& record) override {
    if (const auto* scan = std::get_if<ScanRecord>(&record)) {
      return write_scan(*scan);
    } else if (const auto* odometry = std::get_if<Odometry>(&record)) {
      T_odom_last_ = odometry->T_odom_base;
      sink_.write(writer_.odometry(*odometry));
    } else if (const auto* encoder = std::get_if<Encoder>(&record)) {
      sink_.write(writer_.encoder(*encoder));
    } else if (const auto* tilt = std::get_if<Tilt>(&record)) {
      sink_.write(writer_.tilt(*tilt));
    } else if (const auto* parameter = std::get_if<Parameter>(&record)) {
      return write_parameter(*parameter);
    }
    return true;
  }
  void finish() override { sink_.finish(); }
  [[nodiscard]] std::uint64_t bytes() const override { return sink_.bytes(); }

 private:
  bool write_parameter(const Parameter& parameter) {
    if (!is_one_word(parameter.name) || !is_one_word(parameter.value)) {
      leave_out("parameter", "a name or value of no word or several: " + in_quotes(parameter.name));
      return false;
    }
    if (parameter.name == kLimitParameter) {
      double limit_m = 0.0;
      const char* const end = parameter.value.data() + parameter.value.size();
      const bool is_number = parse_double(parameter.value.data(), end, limit_m) == end;
      if (is_number && limit_m > 0.0 && std::isfinite(limit_m)) {  // otherwise readers ignore it
        told_max_range_m_ = limit_m;
        told_laser_ = 0;
      }
    }
    sink_.write(writer_.parameter(parameter.name, parameter.value));
    return true;
  }

  // False if readers would give the scan another limit than its own. They give a scan without a limit the last stated
  // one, of either laser, and nothing can revoke it.
  bool tell_limit(const ScanRecord& record, const std::string& at) {
    const double limit_m = record.scan.max_range_m;
    const bool is_known = limit_m > 0.0;
    const bool is_of_other = told_laser_ && *told_laser_ != record.laser;
    if (!is_known && is_of_other) {
      leave_out("scan of unknown limit", at + " would get that of the other laser");
      return false;
    }
    has_no_limit_[record.laser] = !is_known;
    if (!is_known) {
      if (told_laser_) leave_out("limit that is not known", at + " gets the one before");
      told_max_range_m_ = 0.0;
      return true;
    }
    if (limit_m == told_max_range_m_ || !writer_.is_told_by_beam_count(record.scan)) return true;
    const bool is_own = told_laser_ && !is_of_other;  // scans of the other laser are left out already
    if (has_no_limit_[1 - record.laser] && !is_own) {
      leave_out(is_of_other ? "scan of another limit" : "limit of the ranges",
                at + ": that of the other laser is not known");
      return !is_of_other;
    }
    told_max_range_m_ = limit_m;
    told_laser_ = record.laser;
    sink_.write(writer_.parameter(kLimitParameter, fmt::format("{}", limit_m)));
    return true;
  }

  bool write_scan(ScanRecord record) {
    LaserScan& scan = record.scan;
    const std::string at = fmt::format("scan at {:.6f} s", scan.stamp_s);
    if (record.laser > 1) {
      leave_out("scan of a third laser", at);
      return false;
    }
    turn_beams_right_to_left(scan);
    if (!tell_limit(record, at)) return false;
    if (scan.first_beam_after_s != 0.0 || scan.beam_period_s != 0.0) leave_out("time of each beam", at);
    if (!record.T_odom_base) {
      leave_out("missing odometry", at + " gets the pose of the odometry before it");
      record.T_odom_base = T_odom_last_;
    }
    T_odom_last_ = *record.T_odom_base;
    sink_.write(writer_.scan(record));
    return true;
  }

  TextSink sink_;
  CarmenWriter writer_;
  Pose2 T_odom_last_;
  double told_max_range_m_ = 0.0;            ///< limit of the last PARAM; 0 if it must be written again
  std::optional<std::size_t> told_laser_{};  ///< laser of that PARAM
  std::array<bool, 2> has_no_limit_{};       ///< for the last scan of each laser
};

}  // namespace

std::unique_ptr<LogWriter> make_carmen_log(AtomicFile& file) { return std::make_unique<CarmenLog>(file); }

}  // namespace gdtslam
