// The log of a pipe or of a live drive, kept while it is read: JSON lines in frames of zstd, one at least each second,
// so that a process that is killed loses no more than its last second. One object belongs to one thread.
#pragma once

#include <chrono>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/io/log.hpp"

namespace gdtslam {

/// Whether a log can be read only once: standard input, a pipe, a device.
bool is_stream(const std::string& log);

/// The file of a stream's records. Throws FileError.
class StreamFile {
 public:
  explicit StreamFile(std::string file);
  void add(const LogRecord& record);
  /// Writes what is not written yet.
  void flush();
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::ofstream file_;
  std::string lines_;
  std::chrono::steady_clock::time_point written_at_;
};

/// Gives the records of a log, and writes each into the file. Throws FileError too.
class KeptStream final : public LogReader {
 public:
  KeptStream(std::unique_ptr<LogReader> log, std::shared_ptr<StreamFile> file)
      : log_(std::move(log)), file_(std::move(file)) {}
  std::optional<LogRecord> next() override;
  [[nodiscard]] double progress() const override { return log_->progress(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const override { return log_->warnings(); }

 private:
  std::unique_ptr<LogReader> log_;
  std::shared_ptr<StreamFile> file_;
};

}  // namespace gdtslam
