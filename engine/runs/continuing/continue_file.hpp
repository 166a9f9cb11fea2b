// Keeps the log of a pipe or of a live drive while it is read, as JSON lines in frames of zstd. A frame ends at least
// each second, so a killed process loses at most its last second. One object belongs to one thread.
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

/// True if a log can be read only once: standard input, a pipe, a device.
bool is_stream(const std::string& log);

/// The file of a stream's records. A side thread writes them each second, also while the sender pauses. Throws
/// FileError.
class StreamFile {
 public:
  explicit StreamFile(std::string file);
  StreamFile(const StreamFile&) = delete;
  StreamFile& operator=(const StreamFile&) = delete;
  ~StreamFile();
  void add(const LogRecord& record);
  /// Returns once all records are on the disk.
  void sync();
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] bool has_scan() const { return has_scan_; }

 private:
  void write();
  void work();

  std::string path_;
  std::ofstream file_;
  bool has_scan_ = false;
  std::mutex mutex_;  // guards the members below
  std::string lines_;
  bool is_over_ = false;
  std::condition_variable over_;
  std::thread thread_;
};

/// Reads the records of a log, and writes each to the file. Also throws FileError.
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

// continue.json of a run: its request and its logs, so that it can be continued (docs/formats.md). Thread-safe;
// O(text), plus one reading of the logs for their hashes.

inline constexpr const char* kContinueFile = "continue.json";

/// A log that a run read.
struct KeptLog {
  std::string name;    ///< the given name
  std::string path;    ///< absolute path; for a log that the run keeps, the name of its file
  std::string sha256;  ///< hash of the file; for a folder, of the hashes of its files in the order of their names
};

/// The logs, and the parts of a request that determine the result; the rest has its defaults.
struct KeptRequest {
  MapRequest request;
  std::vector<KeptLog> logs;
  std::string linkage_sha256{};  ///< hash of the linkage, if that is a file
};

/// A mapped log: `before` is its state at the start, `kept_file` the run's copy of it, if any. Without a hash if the
/// log has changed since, or cannot be read again. Throws FileError.
KeptLog kept_log(const std::string& log, const std::optional<FileState>& before, const std::string& kept_file);

/// Atomic. Throws FileError.
void write_continue_file(const std::string& file, const KeptRequest& kept);
/// Reads continue.json of the run in `folder`. Throws InputError or ConfigError for another version, FileError.
KeptRequest read_continue_file(const std::string& file, const std::string& folder);

/// The current path of the log: its given name, if that is still the same log. Throws InputError if it is missing, or
/// has other bytes than the run in `folder` read.
std::string log_of_run(const KeptLog& log, const std::string& folder);

/// `request` with the options of the run in request.continued, and with that run's logs before its own. Throws like
/// read_continue_file() and log_of_run(), and UsageError if the logs cannot be added.
MapRequest continued_request(const MapRequest& request);

}  // namespace gdtslam
