#include "table_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <deque>
#include <string_view>
#include <utility>
#include <variant>

#include "engine/io/text_log.hpp"
#include "gdtslam/core/error.hpp"
#include "row_parser.hpp"
#include "row_records.hpp"

namespace gdtslam {
namespace {

/// In the order of LogRecord's alternatives.
constexpr std::array<std::string_view, std::variant_size_v<LogRecord>> kRecordNames{"scans", "odometry", "ticks",
                                                                                    "elevations", "parameters"};

class TableReader final : public TextLog {
 public:
  TableReader(TableKind kind, std::unique_ptr<ByteSource> source, std::string name, const ReadOptions& options)
      : TextLog(kind == TableKind::kCsv ? "CSV" : "JSON lines", std::move(source), std::move(name), options),
        is_csv_(kind == TableKind::kCsv),
        rows_(options) {}

  std::optional<LogRecord> next() override {
    while (ready_.empty()) {
      const std::optional<TextLine> line = next_line();
      if (!line) {
        finish(fmt::format("is {} of {} lines without a complete row; docs/formats.md shows how a log looks",
                           is_csv_ ? "a CSV file" : "a file of JSON lines", last_line_));
        return std::nullopt;
      }
      take(*line);
    }
    LogRecord record = std::move(ready_.front());
    ready_.pop_front();
    return record;
  }

 private:
  void take(const TextLine& line) {
    const std::string_view text = without_byte_order_mark(line);
    const std::size_t begin = text.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos || text[begin] == '#') return;
    const char last = text[text.find_last_not_of(" \t\r")];
    if (records_ == 0 && line.has_newline && !text.ends_with("[[") && text[begin] == '{' &&
        std::string_view("{[,").find(last) != std::string_view::npos) {
      throw InputError({name_, 0}, fault_of_foreign_line(text.substr(begin)));
    }
    try {
      if (line.is_too_long) throw MalformedRow(fmt::format("is longer than {} bytes", kMaxLogLineBytes));
      TableRow row;
      RangeRepairs repairs;
      if (!parse(text, row)) return;
      std::vector<LogRecord> records = rows_.records(row, repairs);
      if (!line.has_newline && is_csv_) throw MalformedRow("may be cut off: no line end is behind it");
      note_repairs(repairs);
      for (LogRecord& record : records) {
        if (const auto* scan = std::get_if<ScanRecord>(&record)) note_scan(*scan);
        kinds_.add(kRecordNames.at(record.index()), true);
        ++records_;
        ready_.push_back(std::move(record));
      }
    } catch (const MalformedRow& error) {
      const bool is_cut = !line.has_newline && !line.is_too_long;
      if (!is_cut && is_csv_ && csv_.wants_header()) {
        throw InputError({name_, line.number},
                         fmt::format("the header {}; docs/formats.md lists the columns", error.what()));
      }
      refuse(line, "the row", error.what());
    }
  }

  bool parse(std::string_view text, TableRow& row) {
    const RowWarn warned = [this](std::string_view kind, std::string_view detail) { warn(kind, detail); };
    if (is_csv_) return csv_.parse(text, row, warned);
    parse_json_row(text, row, warned);
    return true;
  }

  bool is_csv_;
  CsvRows csv_;
  RowRecords rows_;
  std::deque<LogRecord> ready_;
};

}  // namespace

std::unique_ptr<DescribedLog> open_table(TableKind kind, std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                         const ReadOptions& options) {
  return std::make_unique<TableReader>(kind, std::move(unpacked), name, options);
}

}  // namespace gdtslam
