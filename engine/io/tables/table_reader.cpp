#include "table_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <deque>
#include <string_view>
#include <utility>
#include <variant>

#include "csv_rows.hpp"
#include "engine/io/text_log.hpp"
#include "foreign_file.hpp"
#include "gdtslam/core/error.hpp"
#include "json_rows.hpp"
#include "row_records.hpp"

namespace gdtslam {
namespace {

/// In the order of LogRecord's alternatives.
constexpr std::array<std::string_view, std::variant_size_v<LogRecord>> kRecordNames{"scans", "odometry", "ticks",
                                                                                    "elevations", "parameters"};

class TableReader final : public TextLog {
 public:
  TableReader(std::unique_ptr<RowParser> parser, std::string_view format, std::unique_ptr<ByteSource> source,
              std::string name, const ReadOptions& options)
      : TextLog(format, std::move(source), std::move(name), options), parser_(std::move(parser)), rows_(options) {}

  std::optional<LogRecord> next() override {
    while (ready_.empty()) {
      const std::optional<TextLine> line = next_line();
      if (!line) {
        finish(fmt::format("is {} of {} lines without a complete row; docs/formats.md shows how a log looks",
                           parser_->kind(), last_line_));
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
      if (!parser_->parse(text, row, warner())) return;
      std::vector<LogRecord> records = rows_.records(row, repairs);
      if (!line.has_newline && parser_->can_hide_cut()) throw MalformedRow("may be cut off: no line end is behind it");
      note_repairs(repairs);
      for (LogRecord& record : records) {
        if (const auto* scan = std::get_if<ScanRecord>(&record)) note_scan(*scan);
        kinds_.add(kRecordNames.at(record.index()), true);
        ++records_;
        ready_.push_back(std::move(record));
      }
    } catch (const MalformedRow& error) {
      const bool is_cut = !line.has_newline && !line.is_too_long;
      if (!is_cut && parser_->wants_header()) {
        throw InputError({name_, line.number},
                         fmt::format("the header {}; docs/formats.md lists the columns", error.what()));
      }
      refuse(line, "the row", error.what());
    }
  }

  RowParser::Warn warner() {
    return [this](std::string_view kind, std::string_view detail) { warn(kind, detail); };
  }

  std::unique_ptr<RowParser> parser_;
  RowRecords rows_;
  std::deque<LogRecord> ready_;
};

}  // namespace

std::unique_ptr<DescribedLog> open_table(TableKind kind, std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                         const ReadOptions& options) {
  std::unique_ptr<RowParser> parser;
  if (kind == TableKind::kCsv) {
    parser = std::make_unique<CsvRows>();
  } else {
    parser = std::make_unique<JsonRows>();
  }
  return std::make_unique<TableReader>(std::move(parser), kind == TableKind::kCsv ? "CSV" : "JSON lines",
                                       std::move(unpacked), name, options);
}

}  // namespace gdtslam
