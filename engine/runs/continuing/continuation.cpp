#include "continuation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <system_error>

#include "engine/io/atomic_file.hpp"
#include "engine/io/binary/log_copy.hpp"
#include "engine/io/binary/log_copy_records.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/error.hpp"
#include "log_copies.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

bool is_a_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

// Of two folders the first that has it.
std::string file_in(const std::vector<fs::path>& folders, const std::string& name) {
  for (const fs::path& folder : folders) {
    if (is_a_file(folder / name)) return (folder / name).string();
  }
  return {};
}

// What a finished run left to go on with has the bytes that its report tells of.
RunFiles checked_files(const std::string& run, std::size_t copies) {
  RunFiles files(run);
  (void)files.checked(kContinueFile);
  for (std::size_t log = 0; log < copies; ++log) (void)files.checked(log_copy_name(log));
  return files;
}

// Whether all of each log is there, and the run has nothing more to read.
bool is_all_read(const KeptRequest& kept, const std::vector<std::string>& copies) {
  return copies.size() == kept.request.logs.size() &&
         (copies.empty() || extent_of_log_copy(copies.back()).is_of_whole_log());
}

bool has_same_records(const std::string& copy, const std::string& log, const ReadOptions& options,
                      const std::function<bool()>& stop) {
  try {
    const std::unique_ptr<LogReader> copied = open_log(copy, options);
    const std::unique_ptr<LogReader> read = open_log(log, options);
    while (const std::optional<LogRecord> record = read->next()) {
      if (stop && stop()) {
        throw Error(ExitCode::kInterrupted, "interrupted while logs were compared; nothing is written");
      }
      const std::optional<LogRecord> other = copied->next();
      if (!other || record_bytes(*record) != record_bytes(*other)) return false;
    }
    return !copied->next();
  } catch (const Error& error) {  // what is wrong with it is told by those who map it
    if (error.code() == ExitCode::kInterrupted) throw;
    return false;
  }
}

// Whether the file that the run has read is this one, whatever it is called now.
bool is_same_file(const std::string& path, const std::string& log) {
  if (path == "-" || log == "-") return path == log;
  std::error_code ignored;  // one may be gone by now
  if (fs::equivalent(path, log, ignored)) return true;
  return fs::path(path).lexically_normal() == fs::path(absolute_path_of(log)).lexically_normal();
}

// Whether the run ends with these logs, and has more than them.
bool ends_with(const KeptRequest& kept, const std::vector<std::string>& last) {
  return kept.paths.size() > last.size() &&
         std::equal(last.rbegin(), last.rend(), kept.paths.rbegin(),
                    [](const std::string& log, const std::string& path) { return is_same_file(path, log); });
}

// A pipe gives its records once, and those who map it are to have them.
bool can_be_read_twice(const std::string& log) {
  std::error_code ignored;
  return log != "-" && (fs::is_regular_file(log, ignored) || fs::is_directory(log, ignored));
}

// Whoever names a copy that lies in the run, which has the records of a log of it, means them a second time.
bool is_copy_in_run(const Continuation& found, const std::string& log) {
  return std::any_of(found.copies.begin(), found.copies.end(), [&](const std::string& copy) {
    std::error_code ignored;
    return fs::equivalent(copy, log, ignored);
  });
}

// Whether a finished run has the records of the first of these logs at its end, wherever it had them from.
bool ends_with_first(const Continuation& found, const std::vector<std::string>& more, std::size_t first,
                     const std::function<bool()>& stop) {
  const KeptRequest& kept = found.kept;
  const ReadOptions options = read_options_of(kept.request.settings.log, kept.request.lenient);
  const std::size_t before = kept.paths.size() - first;
  for (std::size_t k = 0; k < first; ++k) {
    if (!can_be_read_twice(more[k])) return false;
    if (!is_same_file(kept.paths[before + k], more[k]) && is_copy_in_run(found, more[k])) return false;
    if (!has_same_records(found.copies[before + k], more[k], options, stop)) return false;
  }
  return true;
}

// How many of these logs, counted from the first, a finished run has at its end.
std::size_t mapped_already(const Continuation& found, const std::vector<std::string>& more,
                           const std::function<bool()>& stop) {
  std::size_t first = std::min(more.size(), found.kept.paths.size());
  while (first > 0 && !ends_with_first(found, more, first, stop)) --first;
  return first;
}

std::string remark_on(const std::string& run, std::size_t mapped, std::size_t told) {
  const std::string of_these =
      mapped == 1 ? "the first of these logs" : fmt::format("the first {} of these logs", mapped);
  return fmt::format("warning: the run in '{}' ends with {} already: not added once more", run,
                     mapped < told ? of_these : (told == 1 ? "this log" : "these logs"));
}

void refuse_more(const Continuation& found, bool is_finished) {
  const ScanRange& range = found.kept.request.range;
  const bool is_stream = found.kept.request.logs.back() == "-" && found.copies.size() == found.kept.request.logs.size();
  if (!is_finished && !is_stream) {
    throw UsageError(fmt::format(
        "--continue: the run in '{0}' is unfinished: finish it first, gdtslam map --continue {0}", found.run));
  }
  if (range.count != ScanRange{}.count) {
    throw UsageError(
        fmt::format("--continue: the run in '{}' has its first {} scans only (--first), and a further log "
                    "would add nothing: map its logs again without --first",
                    found.run, range.count));
  }
}

// A killed run that was told to go on with these logs may be told so again.
void add_logs(Continuation& found, bool is_finished, const std::vector<std::string>& more,
              const std::function<bool()>& stop) {
  if (more.empty() || (!is_finished && ends_with(found.kept, more))) return;
  const std::size_t mapped = is_finished ? mapped_already(found, more, stop) : 0;
  if (mapped > 0) found.remark = remark_on(found.run, mapped, more.size());
  if (mapped == more.size()) return;
  refuse_more(found, is_finished);
  for (std::size_t log = mapped; log < more.size(); ++log) {
    found.kept.request.logs.push_back(more[log]);
    found.kept.paths.push_back(absolute_path_of(more[log]));
  }
}

}  // namespace

Continuation continuation_of(const std::string& run, const std::vector<std::string>& more_logs,
                             const std::function<bool()>& stop) {
  const UnfinishedRun unfinished = unfinished_run_in(run, kContinueFile);
  std::vector<fs::path> folders;
  if (!unfinished.folder.empty()) folders.push_back(unfinished.folder);
  if (unfinished.folder.empty() || unfinished.is_of_a_commit) folders.emplace_back(run);
  const std::string file = file_in(folders, kContinueFile);
  if (file.empty()) {
    throw InputError({run, 0},
                     "has no run to go on with: no continue.json is in it, as 'gdtslam map' leaves one unless "
                     "--no-copy is given; map its logs again");
  }
  Continuation found{.kept = read_continue_file(file, run), .run = run, .leftover = {}, .copies = {}, .remark = {}};
  if (!unfinished.is_of_a_commit) found.leftover = unfinished.folder;
  for (std::size_t log = 0; log < found.kept.request.logs.size(); ++log) {
    const std::string copy = file_in(folders, log_copy_name(log));
    if (copy.empty()) break;
    found.copies.push_back(copy);
  }
  if (unfinished.folder.empty() && RunReader::is_gdtslam_run(run)) {
    found.files = checked_files(run, found.copies.size());
  }
  const bool is_finished = found.leftover.empty() && is_all_read(found.kept, found.copies);
  add_logs(found, is_finished, more_logs, stop);
  return found;
}

std::unique_ptr<RunFolder> folder_to_continue(const Continuation& continuation, const std::string& path,
                                              ForeignFiles foreign) {
  std::error_code ignored;
  const bool is_taken_over = !continuation.leftover.empty() && fs::equivalent(path, continuation.run, ignored);
  if (is_taken_over) {
    auto folder = std::make_unique<RunFolder>(path, continuation.leftover, foreign);
    write_continue_file(folder->staged_path(kContinueFile), continuation.kept);
    return folder;
  }
  auto folder = std::make_unique<RunFolder>(path, foreign);
  for (std::size_t log = 0; log < continuation.copies.size(); ++log) {
    copy_file_atomically(continuation.copies[log], folder->staged_path(log_copy_name(log)));
  }
  if (continuation.files) continuation.files->expect_unchanged();
  write_continue_file(folder->staged_path(kContinueFile), continuation.kept);
  return folder;
}

}  // namespace gdtslam
