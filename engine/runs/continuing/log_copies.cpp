#include "log_copies.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "engine/io/binary/log_copy.hpp"
#include "engine/io/binary/log_copy_writer.hpp"
#include "engine/runs/continuing/continue_file.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

namespace fs = std::filesystem;

std::string log_copy_name(std::size_t log) { return fmt::format("log-{}.copy", log + 1); }

/// Of the first records there may be a copy already: then they are only compared with it.
class CopiedLog final : public LogReader {
 public:
  CopiedLog(std::unique_ptr<LogReader> log, std::string name) : log_(std::move(log)), name_(std::move(name)) {}

  std::optional<LogRecord> next() override {
    std::optional<LogRecord> record = log_->next();
    if (known_left_ > 0) {
      check(record);
      --known_left_;
    } else if (record) {
      writer_.add(*record);
    } else {
      end(true);
    }
    return record;
  }
  [[nodiscard]] double progress() const override { return log_->progress(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const override { return log_->warnings(); }

  void write_into(const std::string& file) { writer_.write_into(file); }
  /// `known` reads the copy in `file`, which has so many records in so many bytes.
  void go_on_behind(std::unique_ptr<LogReader> known, const std::string& file, std::uint64_t records,
                    std::uint64_t bytes) {
    known_ = std::move(known);
    known_left_ = records;
    known_file_ = file;
    writer_.go_on_with(file, bytes);
  }
  void flush() {
    if (!is_over_ && known_left_ == 0) writer_.flush();
  }
  void end(bool is_all) {
    if (std::exchange(is_over_, true)) return;
    if (known_left_ == 0) writer_.end({is_all, log_->warnings()});
  }

 private:
  void check(const std::optional<LogRecord>& record) {
    const std::optional<LogRecord> copied = known_->next();
    if (record && copied && record_bytes(*record) == record_bytes(*copied)) return;
    throw InputError({name_, 0}, fmt::format("is not the log that the run was reading: it has other records than the "
                                             "copy of its beginning, {}; give that log its place again, or map the "
                                             "copy as it is",
                                             known_file_));
  }

  std::unique_ptr<LogReader> log_;
  std::string name_;
  LogCopyWriter writer_;
  std::unique_ptr<LogReader> known_;
  std::string known_file_;
  std::uint64_t known_left_ = 0;
  bool is_over_ = false;
};

namespace {

/// What the stream of scans owns of a log that is copied; the copy may have to be ended when the stream is gone.
class LentLog final : public LogReader {
 public:
  explicit LentLog(std::shared_ptr<CopiedLog> log) : log_(std::move(log)) {}
  std::optional<LogRecord> next() override { return log_->next(); }
  [[nodiscard]] double progress() const override { return log_->progress(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const override { return log_->warnings(); }

 private:
  std::shared_ptr<CopiedLog> log_;
};

bool is_there(const std::string& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
}

// What came over the standard input does not come again: its copy is all that there is of it.
void end_copy_of_stream(const std::string& file, const LogCopyExtent& extent) {
  LogCopyWriter writer;
  writer.go_on_with(file, extent.whole_bytes);
  writer.end({true, extent.end ? extent.end->warnings : std::vector<LogReader::Warning>{}});
}

}  // namespace

LogCopies::LogCopies(std::vector<std::string> names, std::vector<std::string> paths, const ReadOptions& options,
                     LiveLog live_log)
    : names_(std::move(names)), paths_(std::move(paths)), options_(options), live_log_(std::move(live_log)) {}

LogCopies::~LogCopies() = default;

std::string LogCopies::file(std::size_t log) const { return folder_->staged_path(log_copy_name(log)); }

void LogCopies::write_into(RunFolder& folder) {
  folder_ = &folder;
  if (in_hand_) in_hand_->write_into(file(opened_ - 1));
}

// By its name, which stands in messages, unless a run is gone on with from another folder than before; there too where
// the log has moved with its folder.
std::unique_ptr<LogReader> LogCopies::open_path(std::size_t log) const {
  if (live_log_) return live_log_(options_);
  const bool is_by_name = absolute_path_of(names_[log]) == paths_[log] || !is_there(paths_[log]);
  return open_log(is_by_name ? names_[log] : paths_[log], options_);
}

void LogCopies::start(std::size_t log) {
  in_hand_ = std::make_shared<CopiedLog>(open_path(log), names_[log]);
  if (folder_ != nullptr) in_hand_->write_into(file(log));
}

std::unique_ptr<LogReader> LogCopies::open(std::size_t log) {
  in_hand_.reset();
  opened_ = log + 1;
  if (folder_ == nullptr || !is_there(file(log))) {
    start(log);
    return std::make_unique<LentLog>(in_hand_);
  }
  const std::string copy = file(log);
  const LogCopyExtent extent = extent_of_log_copy(copy);
  if (!extent.is_of_whole_log() && paths_[log] == "-") end_copy_of_stream(copy, extent);
  if (extent.is_of_whole_log() || paths_[log] == "-") return open_log(copy, options_);
  if (extent.whole_bytes == 0) {
    start(log);
    return std::make_unique<LentLog>(in_hand_);
  }
  ReadOptions of_copy = options_;
  of_copy.lenient = true;
  std::unique_ptr<LogReader> known = open_log(copy, of_copy);
  try {
    in_hand_ = std::make_shared<CopiedLog>(open_path(log), names_[log]);
  } catch (const FileError& error) {
    throw FileError(error.what(), fmt::format("the run was reading this log when it ended, and has {} of its records; "
                                              "put it back to go on",
                                              extent.records));
  }
  in_hand_->go_on_behind(std::move(known), copy, extent.sure_records, extent.sure_bytes);
  return std::make_unique<LentLog>(in_hand_);
}

std::string LogCopies::first_log() const {
  if (folder_ != nullptr && is_there(file(0)) && extent_of_log_copy(file(0)).is_of_whole_log()) return file(0);
  return is_there(paths_.front()) ? paths_.front() : names_.front();
}

void LogCopies::finish(bool is_all) {
  if (in_hand_) in_hand_->end(is_all);
  in_hand_.reset();
  folder_->staged(kContinueFile);
  for (std::size_t log = 0; log < names_.size(); ++log) {
    if (!is_there(file(log))) continue;
    sync_file(file(log));
    folder_->staged(log_copy_name(log));
  }
  for (std::size_t log = names_.size(); is_there(folder_->file(log_copy_name(log))); ++log) {
    folder_->without(log_copy_name(log));
  }
}

std::size_t LogCopies::logs_to_keep(std::size_t known) const {
  std::size_t logs = opened_;
  while (logs > known && !live_log_ && paths_[logs - 1] != "-") --logs;
  return logs > known ? logs : 0;
}

void LogCopies::keep(RunFolder& folder, std::size_t logs) {
  std::vector<std::string> names = {kContinueFile};
  for (std::size_t log = 0; log < logs; ++log) names.push_back(log_copy_name(log));
  folder.keep(names);
  try {
    if (in_hand_) in_hand_->flush();
  } catch (const FileError&) {  // as where a disk is full: there is what was written before
  }
}

void LogCopies::leave_out(RunFolder& folder) {
  folder.without(kContinueFile);
  for (std::size_t log = 0; is_there(folder.file(log_copy_name(log))); ++log) folder.without(log_copy_name(log));
}

}  // namespace gdtslam
