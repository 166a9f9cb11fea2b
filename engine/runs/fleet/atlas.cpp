#include "atlas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <system_error>

#include "engine/core/files/folder_calls.hpp"
#include "engine/drawing/letters.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/sha256.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

bool is_ros2_bag(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "metadata.yaml", ignored);
}

// Tables of a run and of an atlas have names like logs, but are not logs.
bool holds_results(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / kReportFile, ignored) || fs::exists(folder / kOptionsFile, ignored);
}

// Links keep their names, which other machines may know; only a path with ".." is resolved.
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

namespace {

namespace fs = std::filesystem;

void require_same_options(const std::string& file, const std::string& options) {
  if (read_text<InputError>(file) == options) return;
  throw UsageError(fmt::format(
      "--output: {} names other options or another version of gdtslam than this command: give a new folder", file));
}

template <class Value>
std::string csv_text(const Value& value) {
  return fmt::format("{}", value);
}
std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_line(const FleetRecord& record, bool is_header) {
  std::string line;
  for_each_field(record, [&](const char* name, const auto& value) {
    line += (line.empty() ? "" : ",") + (is_header ? std::string(name) : csv_text(value));
  });
  return line + "\n";
}

}  // namespace

void begin_atlas(const std::string& atlas, const std::string& options, const std::vector<FleetLog>& logs) {
  const std::string file = fmt::format("{}/{}", atlas, kOptionsFile);
  if (!lies_there(file)) {
    for (const char* const name : {"runs", "logs", "lists", "index.html", "summary.csv", "atlas.json", "report.json"}) {
      if (lies_there(fmt::format("{}/{}", atlas, name)))
        throw UsageError(fmt::format(
            "--output: {} is not an atlas and has {}, which an atlas would replace: give a new folder", atlas, name));
    }
    make_folder(atlas);
    write_file_atomically(file, options);
  }
  require_same_options(file, options);
  std::string list;
  for (const FleetLog& log : logs) list += log.path + "\n";
  constexpr std::size_t kDigits = 16;
  const std::string name = fmt::format("{}/lists/{}.txt", atlas, Sha256().update(list).hex().substr(0, kDigits));
  make_folder(atlas + "/lists");
  make_folder(atlas + "/runs");
  if (!lies_there(name)) write_file_atomically(name, list);
}

std::vector<FleetRecord> read_atlas(const std::string& atlas) {
  if (!lies_there(fmt::format("{}/{}", atlas, kOptionsFile)))
    throw FileError(atlas, fmt::format("is not an atlas; make one with: gdtslam fleet run LOG... -o {}", atlas));
  std::set<std::string> logs;
  std::error_code failed;
  for (const fs::path& list : list_folder(atlas + "/lists", failed)) {
    if (list.extension() != ".txt") continue;
    const std::string text = read_text<InputError>(list.string());
    for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1)
      logs.insert(text.substr(begin, end - begin));
  }
  if (failed) throw FileError(atlas + "/lists", "cannot be read: " + failed.message());
  std::vector<FleetRecord> records;
  for (const std::string& log : logs) {
    std::optional<FleetRecord> record = read_record(atlas, log);
    if (record && record->is_mapped() && !lies_there(fmt::format("{}/{}/{}", atlas, record->run, kReportFile)))
      record.reset();
    records.push_back(record ? std::move(*record) : FleetRecord{.log = log});
  }
  return records;
}

AtlasSummary summarise_atlas(const std::vector<FleetRecord>& records) {
  AtlasSummary summary{.logs = records.size()};
  std::vector<std::string> lines;
  std::set<std::string> hosts;
  for (const FleetRecord& record : records) {
    ++(record.is_mapped()            ? summary.mapped
       : record.outcome == "refused" ? summary.refused
       : record.outcome == "failed"  ? summary.failed
                                     : summary.missing);
    if (!record.host.empty()) hosts.insert(record.host);
    summary.scans += record.scans;
    summary.path_m += record.path_m;
    summary.log_duration_s += record.log_duration_s;
    summary.cpu_s += record.cpu_s;
    lines.push_back(
        fmt::format("{} {} {} {}\n", record.log_sha256, record.options_sha256, record.outcome, record.result_sha256));
  }
  summary.hosts = hosts.size();
  if (summary.failed + summary.missing > 0) return summary;
  std::sort(lines.begin(), lines.end());
  Sha256 hash;
  for (const std::string& line : lines) hash.update(line);
  summary.sha256 = hash.hex();
  return summary;
}

nlohmann::ordered_json atlas_json(const AtlasSummary& summary) {
  using Json = nlohmann::ordered_json;
  return {{"format", 2},
          {"atlas_sha256", summary.sha256.empty() ? Json(nullptr) : Json(summary.sha256)},
          {"logs", summary.logs},
          {"mapped", summary.mapped},
          {"refused", summary.refused},
          {"failed", summary.failed},
          {"missing", summary.missing},
          {"hosts", summary.hosts},
          {"scans", summary.scans},
          {"path_m", summary.path_m},
          {"log_duration_s", summary.log_duration_s},
          {"cpu_s", summary.cpu_s}};
}

std::string summary_csv(const std::vector<FleetRecord>& records) {
  std::string text = csv_line({}, true);
  for (const FleetRecord& record : records) text += csv_line(record, false);
  return text;
}

std::string name_in_atlas(const std::string& log) {
  constexpr std::size_t kLongest = 100;
  constexpr std::size_t kDigits = 12;
  std::string name = log.substr(log.find_last_of('/') + 1).substr(0, kLongest);
  for (char& c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.';
    if (!is_plain && c != '-') c = '_';
  }
  return fmt::format("{}-{}", name, Sha256().update(log).hex().substr(0, kDigits));
}

std::string record_folder(const std::string& atlas, const std::string& log) {
  return fmt::format("{}/logs/{}", atlas, name_in_atlas(log));
}

void write_record(const std::string& atlas, const FleetRecord& record) {
  auto json = nlohmann::ordered_json::object();
  for_each_field(record, [&json](const char* name, const auto& value) { json[name] = value; });
  const std::string folder = record_folder(atlas, record.log);
  make_folder(folder);
  write_json(folder + "/record.json", json);
}

std::optional<FleetRecord> read_record(const std::string& atlas, const std::string& log) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
  try {
    const auto json = read_json(record_folder(atlas, log) + "/record.json", kMostBytes);
    FleetRecord record;
    for_each_field(record, [&json](const char* name, auto& value) { json.at(name).get_to(value); });
    return record;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace gdtslam
