#include "table_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <deque>
#include <map>
#include <string_view>
#include <utility>
#include <variant>

#include "csv_rows.hpp"
#include "engine/io/line_reader.hpp"
#include "engine/io/log_contents.hpp"
#include "engine/io/scan_sequence.hpp"
#include "engine/io/unpack_source.hpp"
#include "engine/io/warning_counter.hpp"
#include "foreign_file.hpp"
#include "gdtslam/core/error.hpp"
#include "json_rows.hpp"
#include "row_records.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMaxTableLineBytes = std::size_t{4} << 20U;
/// In the order of LogRecord's alternatives.
constexpr std::array<std::string_view, std::variant_size_v<LogRecord>> kRecordNames{"scans", "odometry", "ticks",
                                                                                    "elevations", "parameters"};

class TableReader final : public DescribedLog {
 public:
  TableReader(std::unique_ptr<RowParser> parser, std::string_view format, std::unique_ptr<ByteSource> source,
              std::string name, const ReadOptions& options)
      : format_(format),
        name_(std::move(name)),
        is_lenient_(options.lenient),
        parser_(std::move(parser)),
        lines_(std::move(source), kMaxTableLineBytes),
        rows_(options) {}

  std::optional<LogRecord> next() override {
    while (ready_.empty()) {
      last_line_ = lines_.skip_empty_lines();
      const std::optional<TextLine> line = lines_.next();
      if (!line) {
        finish();
        return std::nullopt;
      }
      take(*line);
    }
    LogRecord record = std::move(ready_.front());
    ready_.pop_front();
    return record;
  }
  [[nodiscard]] double progress() const override { return lines_.source().progress(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const override { return warnings_.list(); }
  [[nodiscard]] LogContents contents() const override {
    LogContents contents;
    contents.format = format_;
    contents.lines = kinds_.list();
    return contents;
  }

 private:
  void take(const TextLine& line) {
    last_line_ = line.number;
    std::string_view text = line.text;
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (line.number == 1 && text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
    const std::size_t begin = text.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos || text[begin] == '#') return;
    const char last = text[text.find_last_not_of(" \t\r")];
    if (records_ == 0 && line.has_newline && !text.ends_with("[[") && text[begin] == '{' &&
        std::string_view("{[,").find(last) != std::string_view::npos) {
      throw InputError({name_, 0}, fault_of_foreign_line(text.substr(begin)));
    }
    try {
      if (line.is_too_long) throw MalformedRow(fmt::format("is longer than {} bytes", kMaxTableLineBytes));
      TableRow row;
      RowRepairs repairs;
      if (!parser_->parse(text, row, warner())) return;
      std::vector<LogRecord> records = rows_.records(row, repairs);
      if (!line.has_newline && parser_->can_hide_cut()) throw MalformedRow("may be cut off: no line end is behind it");
      if (repairs.not_a_number > 0) warn("range not a number", "taken as no return", repairs.not_a_number);
      if (repairs.negative > 0) warn("negative range", "taken as no return", repairs.negative);
      for (LogRecord& record : records) {
        if (const auto* scan = std::get_if<ScanRecord>(&record)) sequences_[scan->laser].check(scan->scan, warner());
        kinds_.add(kRecordNames.at(record.index()), true);
        ++records_;
        ready_.push_back(std::move(record));
      }
    } catch (const MalformedRow& error) {
      refuse(line, error.what());
    }
  }

  void refuse(const TextLine& line, const std::string& reason) {
    if (!line.has_newline && !line.is_too_long) {
      warn("cut last line", reason);
    } else if (parser_->wants_header()) {
      throw InputError({name_, line.number}, fmt::format("the header {}; docs/formats.md lists the columns", reason));
    } else if (is_lenient_) {
      warn("malformed line", reason);
    } else {
      throw InputError({name_, line.number},
                       fmt::format("the row {}; correct it or skip such lines with --lenient, or else with gdtslam "
                                   "convert --lenient",
                                   reason));
    }
  }

  void finish() {
    if (std::exchange(is_finished_, true)) return;
    if (const std::string defect = lines_.source().defect(); !defect.empty()) warn(defect_kind(defect), defect);
    if (records_ > 0) return;
    throw InputError({name_, 0},
                     fmt::format("is {} of {} lines without a complete row; docs/formats.md shows how a log "
                                 "looks",
                                 parser_->kind(), last_line_));
  }

  RowParser::Warn warner() {
    return [this](std::string_view kind, std::string_view detail) { warn(kind, detail); };
  }
  void warn(std::string_view kind, std::string_view detail, std::uint64_t count = 1) {
    if (!warnings_.add_to(kind, count)) {
      warnings_.add(kind, located({name_, last_line_}, std::string(detail)), count);
    }
  }

  std::string_view format_;  ///< of static storage
  std::string name_;
  bool is_lenient_;
  std::unique_ptr<RowParser> parser_;
  LineReader lines_;
  RowRecords rows_;
  WarningCounter warnings_;
  LineCounter kinds_;
  std::map<std::size_t, ScanSequence> sequences_;  ///< of each laser
  std::deque<LogRecord> ready_;
  std::uint64_t last_line_ = 0;
  std::uint64_t records_ = 0;
  bool is_finished_ = false;
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

std::unique_ptr<DescribedLog> open_table(TableKind kind, std::span<const std::byte> data, const std::string& name,
                                         const ReadOptions& options) {
  return open_table(kind, gunzip_if_packed(open_memory_source(data), name), name, options);
}

}  // namespace gdtslam
