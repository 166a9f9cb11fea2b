#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "engine/io/logs/gzip_file.hpp"
#include "engine/io/tables/table_row.hpp"
#include "log_formats.hpp"

namespace gdtslam {
namespace {

/// Numbers in a written CSV file, in order; other columns follow.
constexpr std::array kWrittenNumbers{
    TableNumber::kStamp,          TableNumber::kX,          TableNumber::kY,
    TableNumber::kTheta,          TableNumber::kLaser,      TableNumber::kLaserX,
    TableNumber::kLaserY,         TableNumber::kLaserTheta, TableNumber::kAngleMin,
    TableNumber::kAngleIncrement, TableNumber::kRangeMax,   TableNumber::kFirstBeamAfter,
    TableNumber::kTimeIncrement,  TableNumber::kTicks,      TableNumber::kElevation};
constexpr std::array kRobotPose{TableNumber::kX, TableNumber::kY, TableNumber::kTheta};
constexpr std::array kLaserPose{TableNumber::kLaserX, TableNumber::kLaserY, TableNumber::kLaserTheta};

/// A row by its columns.
struct CsvCells {
  std::array<std::string, kTableNumbers> numbers{};
  std::string name{};
  std::string value{};
  std::string ranges{};

  std::string& operator[](TableNumber number) { return numbers[static_cast<std::size_t>(number)]; }
  [[nodiscard]] std::string line() const {
    std::string text;
    for (const TableNumber number : kWrittenNumbers) (text += numbers[static_cast<std::size_t>(number)]) += ',';
    return text + fmt::format("{},{},{}\n", name, value, ranges);
  }
};

std::string csv_header() {
  CsvCells names{
      .name = std::string(kNameColumn), .value = std::string(kValueColumn), .ranges = std::string(kRangesColumn)};
  for (const TableNumber number : kWrittenNumbers) names[number] = table_name(number);
  return names.line();
}

std::string shortest(double value) { return fmt::format("{}", value); }

void fill_pose(CsvCells& cells, const Pose2& pose, const std::array<TableNumber, 3>& columns) {
  cells[columns[0]] = shortest(pose.x_m);
  cells[columns[1]] = shortest(pose.y_m);
  cells[columns[2]] = shortest(pose.theta_rad);
}

std::string csv_text(std::string_view text) {
  if (text.find_first_of(",\" \t\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' || c == '\r' ? ' ' : c;  // a record must be a line
  }
  return quoted + '"';
}

void fill_scan(CsvCells& cells, const ScanRecord& record) {
  const LaserScan& scan = record.scan;
  cells[TableNumber::kStamp] = shortest(scan.stamp_s);
  if (record.T_odom_base) fill_pose(cells, *record.T_odom_base, kRobotPose);
  cells[TableNumber::kLaser] = std::to_string(record.laser);
  fill_pose(cells, scan.T_base_laser, kLaserPose);
  cells[TableNumber::kAngleMin] = shortest(scan.first_bearing_rad);
  cells[TableNumber::kAngleIncrement] = shortest(scan.bearing_step_rad);
  cells[TableNumber::kRangeMax] = shortest(scan.max_range_m);
  cells[TableNumber::kFirstBeamAfter] = shortest(scan.first_beam_after_s);
  cells[TableNumber::kTimeIncrement] = shortest(scan.beam_period_s);
  std::string& list = cells.ranges;
  for (const float range_m : scan.ranges_m) fmt::format_to(std::back_inserter(list), "{} ", range_m);
  list.empty() ? void(list = "none") : list.pop_back();
}

void append_numbers(std::string& line, std::string_view key, std::initializer_list<double> numbers) {
  fmt::format_to(std::back_inserter(line), ",\"{}\":[{}]", key, fmt::join(numbers, ","));
}

void append_pose(std::string& line, std::string_view key, const Pose2& pose) {
  append_numbers(line, key, {pose.x_m, pose.y_m, pose.theta_rad});
}

template <class Number>
void append_number(std::string& line, TableNumber key, Number number) {
  fmt::format_to(std::back_inserter(line), ",\"{}\":{}", table_name(key), number);
}

std::string json_line_at(double stamp_s) {
  return fmt::format("{{\"{}\":{}", table_name(TableNumber::kStamp), stamp_s);
}

std::string scan_line(const ScanRecord& record) {
  const LaserScan& scan = record.scan;
  std::string line = json_line_at(scan.stamp_s);
  if (record.T_odom_base) append_pose(line, kOdomKey, *record.T_odom_base);
  append_pose(line, kMountKey, scan.T_base_laser);
  append_number(line, TableNumber::kLaser, record.laser);
  append_number(line, TableNumber::kAngleMin, scan.first_bearing_rad);
  append_number(line, TableNumber::kAngleIncrement, scan.bearing_step_rad);
  append_number(line, TableNumber::kRangeMax, scan.max_range_m);
  append_number(line, TableNumber::kFirstBeamAfter, scan.first_beam_after_s);
  append_number(line, TableNumber::kTimeIncrement, scan.beam_period_s);
  fmt::format_to(std::back_inserter(line), ",\"{}\":[", kRangesColumn);
  for (const float range_m : scan.ranges_m) {  // JSON has no infinity
    line += std::isfinite(range_m) ? fmt::format("{},", range_m) : "null,";
  }
  if (!scan.ranges_m.empty()) line.pop_back();
  return line + ']';
}

std::string json_string(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string csv_line(const LogRecord& record) {
  CsvCells cells;
  if (const auto* scan = std::get_if<ScanRecord>(&record)) {
    fill_scan(cells, *scan);
  } else if (const auto* odometry = std::get_if<Odometry>(&record)) {
    cells[TableNumber::kStamp] = shortest(odometry->stamp_s);
    fill_pose(cells, odometry->T_odom_base, kRobotPose);
  } else if (const auto* encoder = std::get_if<Encoder>(&record)) {
    cells[TableNumber::kStamp] = shortest(encoder->stamp_s);
    cells[TableNumber::kTicks] = std::to_string(encoder->ticks);
  } else if (const auto* tilt = std::get_if<Tilt>(&record)) {
    cells[TableNumber::kStamp] = shortest(tilt->stamp_s);
    cells[TableNumber::kElevation] = shortest(tilt->elevation_rad);
  } else if (const auto* parameter = std::get_if<Parameter>(&record)) {
    cells.name = csv_text(parameter->name);
    cells.value = csv_text(parameter->value);
  }
  return cells.line();
}

/// Every record is a line.
class LinesLog final : public LogWriter {
 public:
  LinesLog(AtomicFile& file, std::string (*line)(const LogRecord&), const std::string& header)
      : sink_(file), line_(line) {
    sink_.write(header);
  }
  bool write(const LogRecord& record) override {
    sink_.write(line_(record));
    return true;
  }
  void finish() override { sink_.finish(); }
  [[nodiscard]] std::uint64_t bytes() const override { return sink_.bytes(); }

 private:
  TextSink sink_;
  std::string (*line_)(const LogRecord&);
};

}  // namespace

std::string json_line(const LogRecord& record) {
  std::string line;
  if (const auto* scan = std::get_if<ScanRecord>(&record)) {
    line = scan_line(*scan);
  } else if (const auto* odometry = std::get_if<Odometry>(&record)) {
    line = json_line_at(odometry->stamp_s);
    append_pose(line, kOdomKey, odometry->T_odom_base);
  } else if (const auto* encoder = std::get_if<Encoder>(&record)) {
    line = json_line_at(encoder->stamp_s);
    append_number(line, TableNumber::kTicks, encoder->ticks);
  } else if (const auto* tilt = std::get_if<Tilt>(&record)) {
    line = json_line_at(tilt->stamp_s);
    append_number(line, TableNumber::kElevation, tilt->elevation_rad);
  } else if (const auto* parameter = std::get_if<Parameter>(&record)) {
    line = fmt::format("{{\"{}\":{},\"{}\":{}", kNameColumn, json_string(parameter->name), kValueColumn,
                       json_string(parameter->value));
  }
  return line + "}\n";
}

std::unique_ptr<LogWriter> make_csv_log(AtomicFile& file) {
  return std::make_unique<LinesLog>(file, csv_line, csv_header());
}

std::unique_ptr<LogWriter> make_json_lines_log(AtomicFile& file) {
  return std::make_unique<LinesLog>(file, json_line, "");
}

}  // namespace gdtslam
