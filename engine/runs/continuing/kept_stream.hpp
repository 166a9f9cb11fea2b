// The log of a pipe or of a live drive, kept while it is read: JSON lines in frames of zstd, one at least each second,
// so that a process that is killed loses no more than its last second. One object belongs to one thread.
#pragma once

#include <condition_variable>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "gdtslam/io/log.hpp"

namespace gdtslam {

/// Whether a log can be read only once: standard input, a pipe, a device.
bool is_stream(const std::string& log);

/// The file of a stream's records. A thread beside writes them each second, so that they are there while the sender
/// pauses. Throws FileError.
class StreamFile {
 public:
  explicit StreamFile(std::string file);
  StreamFile(const StreamFile&) = delete;
  StreamFile& operator=(const StreamFile&) = delete;
  ~StreamFile();
  void add(const LogRecord& record);
  /// All of it is on the disk.
  void sync();
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] bool has_scan() const { return has_scan_; }

 private:
  void write();
  void work();

  std::string path_;
  std::ofstream file_;
  bool has_scan_ = false;
  std::mutex mutex_;  // of what follows
  std::string lines_;
  bool is_over_ = false;
  std::condition_variable over_;
  std::thread thread_;
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
