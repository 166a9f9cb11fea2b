#include "run_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>
#include <utility>

#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

bool is_whole_value(const ReportReader::Value& value) { return value.is_number_unsigned(); }
bool is_number_value(const ReportReader::Value& value) { return value.is_number(); }
bool is_truth_value(const ReportReader::Value& value) { return value.is_boolean(); }
bool is_text_value(const ReportReader::Value& value) { return value.is_string(); }
bool is_list_value(const ReportReader::Value& value) { return value.is_array(); }

}  // namespace

ReportReader::ReportReader(std::string file, std::string advice, Value report)
    : file_(std::move(file)),
      advice_(std::move(advice)),
      report_(std::make_shared<const Value>(std::move(report))),
      object_(report_.get()) {
  if (!object_->is_object()) fail("does not hold a JSON object");
}

const ReportReader::Value& ReportReader::at(const char* key) const {
  const auto found = object_->find(key);
  if (found == object_->end()) fail(fmt::format("has no '{}{}'", path_, key));
  return *found;
}

const ReportReader::Value& ReportReader::at(const char* key, IsOfType is_of_type, const char* type) const {
  const Value& value = at(key);
  if (!is_of_type(value)) fail(key, fmt::format("is not {}", type));
  return value;
}

std::uint64_t ReportReader::whole(const char* key) const {
  return at(key, is_whole_value, "a whole number").get<std::uint64_t>();
}

std::size_t ReportReader::index(const char* key, std::uint64_t end) const {
  const std::uint64_t value = whole(key);
  if (value >= end) fail(key, fmt::format("names a scan that is none of its {}", end));
  return static_cast<std::size_t>(value);
}

double ReportReader::number(const char* key) const { return at(key, is_number_value, "a number").get<double>(); }

std::vector<double> ReportReader::numbers_in(const Value& value, const char* key, std::size_t count,
                                             double most) const {
  const auto is_within = [most](const Value& entry) {
    return entry.is_number() && std::fabs(entry.get<double>()) <= most;  // false for NaN too
  };
  if (!value.is_array() || value.size() != count || !std::all_of(value.begin(), value.end(), is_within)) {
    fail(key, fmt::format("is not {} numbers from {:g} to {:g}", count, -most, most));
  }
  return value.get<std::vector<double>>();
}

std::vector<double> ReportReader::numbers(const char* key, std::size_t count, double most) const {
  return numbers_in(at(key), key, count, most);
}

std::vector<std::vector<double>> ReportReader::rows(const char* key, std::size_t count, double most) const {
  std::vector<std::vector<double>> rows;
  for (const Value& row : list(key)) rows.push_back(numbers_in(row, key, count, most));
  return rows;
}

std::optional<double> ReportReader::number_or_null(const char* key) const {
  return at(key).is_null() ? std::nullopt : std::optional(number(key));
}

bool ReportReader::has(const char* key) const { return object_->contains(key); }

bool ReportReader::truth(const char* key) const { return at(key, is_truth_value, "true or false").get<bool>(); }

std::string ReportReader::text(const char* key) const { return at(key, is_text_value, "a text").get<std::string>(); }

GridGeometry ReportReader::geometry(const char* key) const {
  const ReportReader grid = section(key);
  const std::vector<double> origin_m = grid.numbers("origin_m", 2, std::numeric_limits<double>::max());
  const auto side = [&grid](const char* name) {
    const std::uint64_t cells = grid.whole(name);
    if (cells > std::numeric_limits<std::int32_t>::max()) grid.fail(name, "is more cells than a grid has");
    return static_cast<std::int32_t>(cells);
  };
  return {.resolution_m = grid.number("resolution_m"),
          .origin_x_m = origin_m[0],
          .origin_y_m = origin_m[1],
          .width = side("width"),
          .height = side("height")};
}

std::vector<std::string> ReportReader::texts(const char* key) const {
  std::vector<std::string> values;
  for (const Value& value : list(key)) {
    if (!value.is_string()) fail(key, "is not a list of texts");
    values.push_back(value.get<std::string>());
  }
  if (values.empty()) fail(key, "is empty");
  return values;
}

std::vector<std::size_t> ReportReader::indices(const char* key, const char* member, std::uint64_t end) const {
  std::vector<std::size_t> values;
  for (const Value& entry : list(key)) {
    const bool is_member = member != nullptr && entry.is_object() && entry.contains(member);
    const Value& value = is_member ? entry.at(member) : entry;
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= end) {
      fail(key, fmt::format("names a scan that is none of its {}", end));
    }
    values.push_back(value.get<std::size_t>());
  }
  return values;
}

std::vector<ReportFile> ReportReader::files(const char* key) const {
  std::vector<ReportFile> rows;
  for (const Value& row : list(key)) {
    try {
      rows.push_back({row.at(0).get<std::string>(), row.at(1).get<std::uint64_t>(), row.at(2).get<std::string>()});
    } catch (const Value::exception&) {
      fail(key, "is not a list of names, bytes and hashes");
    }
  }
  return rows;
}

const ReportReader::Value& ReportReader::list(const char* key) const { return at(key, is_list_value, "a list"); }

ReportReader ReportReader::section(const char* key) const { return within(at(key), key); }

std::vector<ReportReader> ReportReader::entries(const char* key) const {
  std::vector<ReportReader> readers;
  for (const Value& entry : list(key)) readers.push_back(within(entry, fmt::format("{}[{}]", key, readers.size())));
  return readers;
}

ReportReader ReportReader::within(const Value& object, const std::string& name) const {
  if (!object.is_object()) fail(name.c_str(), "is not an object");
  ReportReader reader = *this;
  reader.object_ = &object;
  reader.path_ = path_ + name + '.';
  return reader;
}

void ReportReader::fail(const std::string& fault) const { throw InputError({file_, 0}, fault + advice_); }

void ReportReader::fail(const char* key, const std::string& fault) const {
  fail(fmt::format("'{}{}' {}", path_, key, fault));
}

ReportReader read_report(const std::string& file, const std::string& folder) {
  const std::string advice = kMapAgain + folder;
  ReportReader report(file, advice, read_json(file, kMostReportBytes, advice));
  const std::uint64_t format = report.whole("format");
  if (format != kReportVersion) {
    report.fail(fmt::format("has format {}, and this program reads format {}", format, kReportVersion));
  }
  return report;
}

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Only maps are changed on purpose: somebody may have cleaned one by hand.
std::string advice_on(const std::string& name) {
  const bool is_of_map = name == "map.pgm" || name == "map.yaml";
  return is_of_map
             ? "; 'gdtslam edit' changes a map, and map.yaml itself, named in place of the folder, is taken as it is"
             : "";
}

}  // namespace

Json files_json(const RunFolder& folder) {
  Json rows = Json::array();
  for (const std::string& name : std::set<std::string>(folder.names().begin(), folder.names().end())) {
    const std::string file = folder.staged_path(name);
    if (fs::is_directory(file)) continue;
    const HashedBytes hashed = sha256_of_file(file);
    rows.push_back({name, hashed.bytes, hashed.sha256});
  }
  return rows;
}

void refuse_folder_of_sites(const std::string& folder) {
  std::error_code ignored;
  if (!fs::exists(fs::path(folder) / kMergeFile, ignored)) return;
  const std::string site = (fs::path(folder) / "1").string();
  throw InputError({folder, 0}, "is what 'gdtslam merge' wrote; give one of its sites, " + site);
}

RunFiles::RunFiles(std::string folder, const std::function<void(const ReportReader&)>& also)
    : folder_(std::move(folder)) {
  report_state_ = state_of_file(path(kReportFile));
  if (!report_state_) {
    std::error_code ignored;
    if (!fs::exists(folder_, ignored)) throw InputError({folder_, 0}, "is no folder of a run: it is not there");
    if (!fs::is_directory(folder_, ignored)) throw InputError({folder_, 0}, "is a file; give the folder of a run");
    refuse_folder_of_sites(folder_);
    throw InputError({folder_, 0},
                     fmt::format("is no folder of a run: it has no {}{}{}", kReportFile, kMapAgain, folder_));
  }
  const ReportReader read = report();
  if (also) also(read);
  if (!read.has("files")) return;
  told_.emplace();
  for (ReportFile& file : read.files("files")) (*told_)[file.name] = std::move(file);
}

std::string RunFiles::path(const std::string& name) const { return (fs::path(folder_) / name).string(); }

bool RunFiles::has(const std::string& name) const {
  std::error_code ignored;
  return told_ ? told_->contains(name) : fs::exists(path(name), ignored);
}

std::string RunFiles::checked(const std::string& name) const {
  const std::optional<FileState> state = state_of_file(path(name));
  if (!state) refuse(name, "is missing in this run");
  if (!told_) return path(name);
  const auto told = told_->find(name);
  if (told == told_->end())
    refuse(name, fmt::format("is none of the files that {} names: not of one run", kReportFile));
  if (is_checked(name, *state)) return path(name);
  const ReportFile& file = told->second;
  if (state->bytes != file.bytes) {
    refuse(name, fmt::format("has {} bytes, but {} names {}: not of one run{}", state->bytes, kReportFile, file.bytes,
                             advice_on(name)));
  }
  if (unless_changed([&] { return sha256_of_file(path(name)); }).sha256 != file.sha256) {
    refuse(name, fmt::format("has another SHA-256 than {} names: not of one run{}", kReportFile, advice_on(name)));
  }
  const std::lock_guard lock(checked_->mutex);
  checked_->states[name] = *state;
  return path(name);
}

bool RunFiles::is_checked(const std::string& name, const FileState& state) const {
  const std::lock_guard lock(checked_->mutex);
  const auto found = checked_->states.find(name);
  return found != checked_->states.end() && found->second == state;
}

// A run is written as a whole, so another run has another report.
void RunFiles::expect_unchanged() const {
  if (state_of_file(path(kReportFile)) == report_state_) return;
  throw InputError({folder_, 0}, "was changed or replaced while it was read; run the command again");
}

ReportReader RunFiles::report() const {
  return unless_changed([this] { return read_report(path(kReportFile), folder_); });
}

// If the whole run was replaced, that is the fault to report.
void RunFiles::refuse(const std::string& name, const std::string& fault) const {
  expect_unchanged();
  throw InputError({path(name), 0}, fault + kMapAgain + folder_);
}

std::optional<RunFiles> told_files_in(const std::string& folder) {
  if (!RunReader::is_run(folder)) return std::nullopt;
  try {
    RunFiles files(folder);
    if (files.is_told()) return files;
  } catch (const InputError&) {  // a report of another program or version
  }
  return std::nullopt;
}

}  // namespace gdtslam
