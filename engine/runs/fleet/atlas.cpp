#include "atlas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "engine/runs/folder/report_reader.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
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
