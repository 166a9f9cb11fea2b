#include "log_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <initializer_list>
#include <string_view>
#include <system_error>

#include "atlas.hpp"
#include "engine/core/files/folder_calls.hpp"
#include "engine/drawing/letters.hpp"
#include "engine/io/message_text.hpp"
#include "engine/runs/folder/report_reader.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

bool is_ros2_bag(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "metadata.yaml", ignored);
}

// The tables of a run and of an atlas have names of logs and are none.
bool holds_results(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / kReportFile, ignored) || fs::exists(folder / kOptionsFile, ignored);
}

// Links keep their names, which other machines may know; only what is above ".." has to be looked up.
fs::path absolute_path(const fs::path& path) {
  fs::path whole = fs::absolute(path);
  whole = std::find(whole.begin(), whole.end(), "..") == whole.end() ? whole.lexically_normal() : fs::canonical(whole);
  return whole.has_filename() ? whole : whole.parent_path();
}

FleetLog log_at(const fs::path& path) {
  FleetLog log{.path = path.string()};
  const bool is_plain = std::none_of(log.path.begin(), log.path.end(), [](char c) { return c >= 0 && c < ' '; });
  if (!is_plain || !is_utf8(log.path))
    throw InputError({log.path, 0}, "has a name with control characters or bytes that are no UTF-8; rename it");
  if (!fs::is_directory(path)) {
    log.bytes = fs::file_size(path);
    return log;
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    if (entry.is_regular_file()) log.bytes += entry.file_size();
  }
  return log;
}

void search(const fs::path& folder, std::vector<FleetLog>& logs) {
  std::error_code failed;
  for (const fs::path& entry : list_folder(folder, failed)) {
    std::error_code ignored;  // an entry that cannot be examined is no log
    const std::string name = entry.filename().string();
    if (name.starts_with('.')) continue;
    if (fs::is_regular_file(entry, ignored)) {
      if (has_name_of_a_log(name)) logs.push_back(log_at(entry));
    } else if (fs::is_directory(fs::symlink_status(entry, ignored))) {
      if (is_ros2_bag(entry)) {
        logs.push_back(log_at(entry));
      } else if (!holds_results(entry)) {
        search(entry, logs);
      }
    }
  }
  if (failed) throw FileError(folder.string(), "cannot be read: " + failed.message());
}

void add_named(const std::string& name, std::vector<FleetLog>& logs) {
  const fs::file_status status = fs::status(name);
  if (!fs::exists(status)) throw FileError(name, "cannot be read: " + errno_text(ENOENT));
  const fs::path path = absolute_path(name);
  if (fs::is_regular_file(status) || is_ros2_bag(path)) {
    logs.push_back(log_at(path));
    return;
  }
  if (!fs::is_directory(status)) throw FileError(name, "is neither a regular file nor a folder");
  if (holds_results(path)) throw InputError({name, 0}, "holds results of gdtslam; name the logs themselves");
  const std::size_t before = logs.size();
  search(path, logs);
  if (logs.size() == before)
    throw InputError({name, 0},
                     fmt::format("holds no file that is named as a log; supported are {} logs", kLogFormats));
}

}  // namespace

bool has_name_of_a_log(const fs::path& file) {
  const auto ends_as = [](const fs::path& name, std::initializer_list<std::string_view> endings) {
    return std::find(endings.begin(), endings.end(), name.extension().string()) != endings.end();
  };
  const bool is_packed = ends_as(file, {".gz", ".bz2", ".xz", ".zst"});
  return ends_as(is_packed ? file.stem() : file, {".log", ".clf", ".csv", ".jsonl", ".bag", ".mcap", ".db3"});
}

std::vector<FleetLog> find_logs(const std::vector<std::string>& named) {
  std::vector<FleetLog> logs;
  for (const std::string& name : named) {
    try {
      add_named(name, logs);
    } catch (const fs::filesystem_error& error) {
      throw FileError(name, "cannot be read: " + error.code().message());
    }
  }
  std::sort(logs.begin(), logs.end(), [](const FleetLog& a, const FleetLog& b) {
    return a.bytes != b.bytes ? a.bytes > b.bytes : a.path < b.path;
  });
  logs.erase(std::unique(logs.begin(), logs.end()), logs.end());
  return logs;
}

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto [slash, code] = std::from_chars(text.data(), end, shard.number);
  const bool has_count = code == std::errc{} && slash != end && *slash == '/';
  const auto [last, count_code] = std::from_chars(has_count ? slash + 1 : end, end, shard.count);
  if (count_code != std::errc{} || last != end || shard.number == 0 || shard.number > shard.count)
    throw UsageError(fmt::format("--shard: {} is not of the form I/N, with I from 1 to N", in_quotes(text)));
  return shard;
}

std::vector<FleetLog> logs_of_shard(const std::vector<FleetLog>& logs, const Shard& shard) {
  std::vector<FleetLog> mine;
  for (std::size_t k = shard.number - 1; k < logs.size(); k += shard.count) mine.push_back(logs[k]);
  return mine;
}

}  // namespace gdtslam
