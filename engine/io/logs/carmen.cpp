#include "carmen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/io/decimal.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/text_log.hpp"
#include "field_cursor.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "steady_mount.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kBinaryProbeBytes = 4096;
constexpr std::size_t kMostKindShown = 40;
constexpr std::string_view kLineBlanks = " \t\r";
constexpr double kFarMountM = 3.0;  // farther than any mount in these logs

constexpr std::size_t kMaxKindLength = 48;

std::size_t read_count(FieldCursor& cursor, std::string_view name) {
  const std::int64_t count = cursor.integer(name);
  const std::size_t most = cursor.bytes_left() / 2;  // a number needs a blank and a digit
  if (count < 0 || static_cast<std::uint64_t>(count) > most) {
    throw MalformedLine(
        fmt::format("states {} as its {}, but the rest of the line holds at most {} numbers", count, name, most));
  }
  return static_cast<std::size_t>(count);
}

std::vector<float> read_ranges(FieldCursor& cursor, std::size_t count, RangeRepairs& repairs) {
  constexpr float kNoReturn = std::numeric_limits<float>::infinity();
  std::vector<float> ranges_m(count);
  for (float& range_m : ranges_m) {
    const double value = cursor.number("range");
    range_m = static_cast<float>(value);
    if (std::isnan(value)) {
      range_m = kNoReturn;
      ++repairs.not_a_number;
    } else if (value < 0.0) {
      range_m = kNoReturn;
      ++repairs.negative;
    }
  }
  return ranges_m;
}

/// `decimals` grows to the most digits after a point.
Pose2 read_pose(FieldCursor& cursor, std::string_view name, int& decimals) {
  const auto next = [&] {
    const double value = cursor.finite(name);
    decimals = std::max(decimals, cursor.decimals());
    return value;
  };
  Pose2 pose;
  pose.x_m = next();
  pose.y_m = next();
  pose.theta_rad = next();
  return pose;
}

/// The end of every message: ipc_timestamp ipc_hostname logger_timestamp.
double read_stamp(FieldCursor& cursor) {
  const double stamp_s = cursor.finite("ipc_timestamp");
  cursor.word("ipc_hostname");
  cursor.number("logger_timestamp");
  cursor.expect_end();
  return stamp_s;
}

/// Two poses with equal digits give an identity mount: no rounding noise for robots whose log has no mount.
Pose2 compute_mount(const Pose2& T_odom_base, const Pose2& T_odom_laser, const ReadOptions& options) {
  if (options.T_base_laser) {
    return *options.T_base_laser;
  }
  return T_odom_base == T_odom_laser ? Pose2{} : between(T_odom_base, T_odom_laser);
}

void apply(const ReadOptions& options, LaserScan& scan) {
  scan.first_bearing_rad = options.first_bearing_rad.value_or(scan.first_bearing_rad);
  scan.bearing_step_rad = options.bearing_step_rad.value_or(scan.bearing_step_rad);
  scan.max_range_m = options.max_range_m.value_or(scan.max_range_m);
}

ScanRecord parse_flaser(FieldCursor& cursor, const ReadOptions& options, CarmenLine& line) {
  ScanRecord record;
  LaserScan& scan = record.scan;
  const std::size_t beams = read_count(cursor, "number of beams");
  scan.ranges_m = read_ranges(cursor, beams, line.repairs);
  const Pose2 T_odom_laser = read_pose(cursor, "laser pose", line.pose_decimals);
  const Pose2 T_odom_base = read_pose(cursor, "robot pose", line.pose_decimals);
  scan.stamp_s = read_stamp(cursor);
  const BearingRule rule = bearing_rule(beams);
  scan.first_bearing_rad = rule.first_rad;
  scan.bearing_step_rad = rule.step_rad;
  scan.T_base_laser = compute_mount(T_odom_base, T_odom_laser, options);
  record.T_odom_base = T_odom_base;
  apply(options, scan);
  return record;
}

/// Lasers are made in degrees: an angle of nine decimals or more is replaced by the angle in degrees with the fewest
/// decimals, up to four, that rounds to it.
double angle_as_made(double rounded_rad, int decimals) {
  constexpr int kFewestAngleDecimals = 9;
  if (decimals < kFewestAngleDecimals) return rounded_rad;
  double taken_rad = 0.5000001;  // most that rounding can change
  for (int k = 0; k < std::min(decimals, 20); ++k) taken_rad /= 10.0;
  const double deg = deg_from_rad(rounded_rad);
  for (double parts = 1.0; parts <= 10000.0; parts *= 10.0) {
    const double made_rad = rad_from_deg(std::floor(deg * parts + 0.5) / parts);
    if (std::fabs(made_rad - rounded_rad) <= taken_rad) return made_rad;
  }
  return rounded_rad;
}

double read_angle(FieldCursor& cursor, std::string_view name) {
  const double rounded_rad = cursor.finite(name);
  return angle_as_made(rounded_rad, cursor.decimals());
}

/// The head of ROBOTLASER1: type start_angle fov resolution max_range accuracy remission_mode.
void read_sensor(FieldCursor& cursor, LaserScan& scan) {
  cursor.integer("laser type");
  scan.first_bearing_rad = read_angle(cursor, "start_angle");
  cursor.finite("field of view");
  scan.bearing_step_rad = read_angle(cursor, "angular resolution");
  scan.max_range_m = cursor.finite("maximum range");
  cursor.finite("accuracy");
  cursor.integer("remission mode");
  if (std::fabs(scan.first_bearing_rad) > kTwoPi) {
    throw MalformedLine(fmt::format("has start_angle {} rad, beyond one turn", scan.first_bearing_rad));
  }
  if (scan.bearing_step_rad <= 0.0 || scan.bearing_step_rad > kPi) {
    throw MalformedLine(fmt::format("has angular resolution {} rad, outside (0, pi]", scan.bearing_step_rad));
  }
  if (scan.max_range_m < 0.0) {
    throw MalformedLine(fmt::format("has the negative maximum range {} m", scan.max_range_m));
  }
}

ScanRecord parse_robotlaser(FieldCursor& cursor, const ReadOptions& options, CarmenLine& line) {
  ScanRecord record;
  LaserScan& scan = record.scan;
  read_sensor(cursor, scan);
  scan.ranges_m = read_ranges(cursor, read_count(cursor, "number of beams"), line.repairs);
  const std::size_t remissions = read_count(cursor, "number of remissions");
  for (std::size_t k = 0; k < remissions; ++k) {
    cursor.number("remission");
  }
  const Pose2 T_odom_laser = read_pose(cursor, "laser pose", line.pose_decimals);
  const Pose2 T_odom_base = read_pose(cursor, "robot pose", line.pose_decimals);
  for (const std::string_view name : {"tv", "rv", "forward safety distance", "side safety distance", "turn axis"}) {
    cursor.number(name);
  }
  scan.stamp_s = read_stamp(cursor);
  scan.T_base_laser = compute_mount(T_odom_base, T_odom_laser, options);
  record.T_odom_base = T_odom_base;
  apply(options, scan);
  return record;
}

Odometry parse_odom(FieldCursor& cursor) {
  Odometry odometry;
  int decimals = 0;
  odometry.T_odom_base = read_pose(cursor, "robot pose", decimals);
  for (const std::string_view name : {"tv", "rv", "accel"}) {
    cursor.number(name);
  }
  odometry.stamp_s = read_stamp(cursor);
  return odometry;
}

/// `PARAM name value ...`: an empty value is allowed, and any text may follow.
Parameter parse_param(FieldCursor& cursor, bool& is_whole) {
  Parameter parameter{std::string(cursor.word("parameter name")), {}};
  if (!cursor.at_end()) {
    parameter.value = cursor.word("value");
  }
  is_whole = !cursor.at_end();
  return parameter;
}

bool is_message_kind(std::string_view word) {
  if (word.size() > kMaxKindLength) {
    return false;
  }
  for (const char& c : word) {
    const bool is_letter = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    const bool is_other = (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
    if (!is_letter && !(is_other && &c != word.data())) {
      return false;
    }
  }
  return true;
}

class CarmenReader final : public TextLog {
 public:
  CarmenReader(std::unique_ptr<ByteSource> source, std::string name, const ReadOptions& options)
      : TextLog("CARMEN", std::move(source), std::move(name), options) {
    const std::string_view head = lines_.peek(kBinaryProbeBytes);
    if (head.empty()) {
      throw InputError({name_, 0}, "is empty" + give_a_log());
    }
    // Uses the first line only, because a pipe may have sent more than that or not.
    const std::string_view first = head.substr(0, head.find('\n'));
    if (const std::string fault = fault_of_foreign_line(first); !fault.empty()) throw InputError({name_, 0}, fault);
    if (first.find('\0') != std::string_view::npos) {
      throw InputError({name_, 0}, "holds binary data" + give_a_log());
    }
  }

  std::optional<LogRecord> next() override {
    while (const std::optional<TextLine> line = next_line()) {
      if (std::optional<LogRecord> record = parse_record(*line)) {
        ++records_;
        return record;
      }
    }
    finish(fmt::format("holds no complete CARMEN message in {} lines{}", last_line_, give_a_log()));
    return std::nullopt;
  }

 private:
  std::optional<LogRecord> parse_record(const TextLine& line) {
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

  /// Checks lines up to the first that is no comment.
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

  /// Handles CARMEN's own name for the limit of the front laser.
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

  std::array<SteadyMount, 2> mounts_;  ///< one for each laser
  double stated_max_range_m_ = 0.0;
  bool is_begun_ = false;
};

}  // namespace

BearingRule bearing_rule(std::size_t beams) {
  if (beams <= 1) {
    return {};
  }
  const bool is_narrow = beams == 101 || beams == 201 || beams == 401;
  const double span_deg = is_narrow ? 100.0 : 180.0;
  const double steps = static_cast<double>(beams % 2 == 1 ? beams - 1 : beams);
  return {.first_rad = rad_from_deg(-span_deg / 2.0), .step_rad = rad_from_deg(span_deg / steps)};
}

CarmenLine parse_carmen_line(std::string_view text, const ReadOptions& options) {
  CarmenLine line;
  FieldCursor cursor(text);
  if (cursor.at_end() || text[text.find_first_not_of(" \t\r")] == '#') {
    return line;
  }
  const std::string_view kind = cursor.word("message kind");
  const bool is_second = options.all_lasers && (kind == "RLASER" || kind == "ROBOTLASER2");
  if (is_second) {
    ScanRecord record =
        kind == "RLASER" ? parse_flaser(cursor, options, line) : parse_robotlaser(cursor, options, line);
    record.laser = 1;
    line.record = std::move(record);
  } else if (kind == "FLASER") {
    line.record = parse_flaser(cursor, options, line);
  } else if (kind == "ODOM") {
    line.record = parse_odom(cursor);
  } else if (kind == "ROBOTLASER1") {
    line.record = parse_robotlaser(cursor, options, line);
  } else if (kind == "ENCODER") {
    const std::int64_t ticks = cursor.integer("ticks");
    line.record = Encoder{read_stamp(cursor), ticks};
  } else if (kind == "TILT") {
    const double elevation_rad = cursor.finite("elevation");
    line.record = Tilt{read_stamp(cursor), elevation_rad};
  } else if (kind == "PARAM") {
    line.record = parse_param(cursor, line.is_whole);
  } else if (is_message_kind(kind)) {
    line.skipped_kind = kind;
  } else {
    throw MalformedLine(fmt::format("starts with {}, which is no CARMEN message", in_quotes(kind)));
  }
  return line;
}

std::unique_ptr<DescribedLog> open_carmen(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                          const ReadOptions& options) {
  return std::make_unique<CarmenReader>(std::move(unpacked), name, options);
}

}  // namespace gdtslam
