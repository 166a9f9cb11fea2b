// The records of a log as rows of CSV and as JSON lines (docs/formats.md). Every number is as short as reads back the
// same, so that a log gives the same map in both. One object belongs to one thread.
#pragma once

#include <cstdint>
#include <string>

#include "engine/io/logs/gzip_file.hpp"
#include "log_writer.hpp"

namespace gdtslam {

class CsvLog final : public LogWriter {
 public:
  /// `file` must outlive this.
  explicit CsvLog(AtomicFile& file);
  bool write(const LogRecord& record) override;
  void finish() override { sink_.finish(); }
  [[nodiscard]] std::uint64_t bytes() const override { return sink_.bytes(); }

 private:
  TextSink sink_;
};

/// A record as a line of JSON, with its end.
std::string json_line(const LogRecord& record);

class JsonLinesLog final : public LogWriter {
 public:
  /// `file` must outlive this.
  explicit JsonLinesLog(AtomicFile& file) : sink_(file) {}
  bool write(const LogRecord& record) override {
    sink_.write(json_line(record));
    return true;
  }
  void finish() override { sink_.finish(); }
  [[nodiscard]] std::uint64_t bytes() const override { return sink_.bytes(); }

 private:
  TextSink sink_;
};

}  // namespace gdtslam
