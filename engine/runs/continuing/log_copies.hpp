// The copies of a run's logs: each is written as its log is read, and read instead of it where it is there already. So
// a run is gone on with whose logs are gone, and one that was killed goes on in the log that it was reading. One object
// belongs to one thread at a time.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "engine/runs/folder/run_folder.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

/// "log-1.copy" of the first log, counted from 0.
std::string log_copy_name(std::size_t log);

/// A log while its copy is written.
class CopiedLog;

class LogCopies {
 public:
  /// Of the logs by their names in messages, and where they are.
  /// `live_log` opens the only one, unless it is empty.
  LogCopies(std::vector<std::string> names, std::vector<std::string> paths, const ReadOptions& options,
            LiveLog live_log = {});
  ~LogCopies();
  /// Copies are in that folder from now on; what was read already goes there. Throws FileError, as the others do.
  void write_into(RunFolder& folder);
  /// The log, or its copy where that has all of it; behind the records that a part has of it the rest is copied too.
  /// Throws InputError too; so does reading where the log is another than the one of which a part was copied.
  std::unique_ptr<LogReader> open(std::size_t log);
  /// What can be read once more beside the run: the copy of the first log where that has all of it, else the log.
  [[nodiscard]] std::string first_log() const;
  /// The last call: the copy in hand ends, and all copies are files of the run. `is_all` says that the run has all that
  /// it wanted of the log in hand, and was not interrupted.
  void finish(bool is_all);
  /// How many logs a run that fails is to keep: up to the last one that was opened and does not come again. None where
  /// that is among the first `known`, which a finished run has.
  [[nodiscard]] std::size_t logs_to_keep(std::size_t known) const;
  /// The run fails: what it has read by now of its first logs stays in the folder, to be gone on with.
  void keep(RunFolder& folder, std::size_t logs);
  /// A run without copies takes away those of an earlier one.
  static void leave_out(RunFolder& folder);

 private:
  [[nodiscard]] std::string file(std::size_t log) const;
  std::unique_ptr<LogReader> open_path(std::size_t log) const;
  void start(std::size_t log);

  std::vector<std::string> names_;
  std::vector<std::string> paths_;
  ReadOptions options_;
  LiveLog live_log_;
  RunFolder* folder_ = nullptr;
  std::size_t opened_ = 0;  ///< the log in hand, counted from 1
  std::shared_ptr<CopiedLog> in_hand_;
};

}  // namespace gdtslam
