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

#include "engine/core/files/file_state.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/runs/map_log.hpp"

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
  std::mutex mutex_;  // guards what follows
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

// continue.json of a run: what it was asked for and which logs it read, so that it can be continued (docs/formats.md).
// Thread-safe; O(text), and what it takes to read the logs once for their hashes.

inline constexpr const char* kContinueFile = "continue.json";

/// A log that a run read.
struct KeptLog {
  std::string name;    ///< name that was given
  std::string path;    ///< absolute; of one that the run itself has, the name of that file
  std::string sha256;  ///< hash of the file; for a folder, of the hashes of its files in the order of their names
};

/// A request as far as it determines the result, and the logs; the rest has its defaults.
struct KeptRequest {
  MapRequest request;
  std::vector<KeptLog> logs;
  std::string linkage_sha256{};  ///< hash of the linkage, if that is a file
};

/// A log that was mapped, whose state was `before` when that began; `kept_file` is the file in which the run keeps it,
/// if it does. Without a hash if the log is another by now, or cannot be read again. Throws FileError.
KeptLog kept_log(const std::string& log, const std::optional<FileState>& before, const std::string& kept_file);

/// Atomic. Throws FileError.
void write_continue_file(const std::string& file, const KeptRequest& kept);
/// Reads continue.json of the run in `folder`. Throws InputError or ConfigError if its version is another, FileError.
KeptRequest read_continue_file(const std::string& file, const std::string& folder);

/// The path of the log now: the name that it was given, if that still names it. Throws InputError where it is not
/// there, or has other bytes than the run in `folder` read.
std::string log_of_run(const KeptLog& log, const std::string& folder);

/// `request` with what the run in request.continued was asked for, and with its logs before its own. Throws what
/// read_continue_file() and log_of_run() throw, and UsageError where the logs cannot be added.
MapRequest continued_request(const MapRequest& request);

}  // namespace gdtslam
