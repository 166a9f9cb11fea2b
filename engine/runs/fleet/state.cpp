#include "state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <utility>

#include "engine/core/ascii.hpp"
#include "engine/core/files/folder_calls.hpp"
#include "engine/core/worker_pool.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "gdtslam/core/error.hpp"
#include "kept_run.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostTableBytes = std::size_t{1} << 30U;
constexpr std::uint64_t kRecordsAtOnce = 256;  // read by one thread

// Other programs leave files of theirs in any folder; a record is what has the very name of one.
std::optional<std::size_t> unit_of_file(const fs::path& file) {
  const std::string name = file.filename().string();
  std::size_t unit = 0;
  if (std::from_chars(name.data(), name.data() + name.size(), unit).ec != std::errc{}) return std::nullopt;
  if (!file.string().ends_with("/" + record_path(unit))) return std::nullopt;
  return unit;
}

bool is_folder_of_records(const fs::path& folder) {
  constexpr std::size_t kDigits = 3;
  const std::string name = folder.filename().string();
  return name.size() == kDigits && is_digits(name);
}

bool is_table(const fs::path& file) {
  std::error_code ignored;
  return file.extension() == ".tsv" && is_digits(file.stem().string()) && fs::is_regular_file(file, ignored);
}

template <class Visit>
void for_each_entry(const fs::path& folder, const Visit& visit) {
  std::error_code failed;
  if (!fs::exists(folder, failed)) {
    if (lies_there(folder)) throw FileError(folder.string(), "is a link that leads nowhere; remove it");
    return;
  }
  for (const fs::path& entry : list_folder(folder, failed)) visit(entry);
  if (failed) throw FileError(folder.string(), "cannot be read: " + failed.message());
}

void read_tables(const std::string& atlas, const StoredPlan& stored, const std::vector<bool>& is_there,
                 AtlasState& state) {
  for_each_entry(fs::path(atlas) / "shards", [&](const fs::path& entry) {
    if (!is_table(entry)) return;
    std::optional<std::vector<UnitRecord>> records;
    try {
      records = parse_records_table(read_text<InputError>(entry.string(), kMostTableBytes), stored.id);
    } catch (const Error&) {  // it only spares reading the records
    }
    if (!records) return;
    for (UnitRecord& record : *records) {
      if (record.unit < is_there.size() && is_there[record.unit]) state.records[record.unit] = std::move(record);
    }
  });
}

// What is wrong with the record, where something is.
std::string read_into(std::optional<UnitRecord>& place, const std::string& atlas, std::size_t unit,
                      const std::string& plan) {
  try {
    UnitRecord record = read_record(atlas, unit);
    if (record.plan != plan)
      throw InputError({atlas + "/" + record_path(unit), 0},
                       "is of another plan; running its shard again does it anew");
    place = std::move(record);
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

// A row counts for the record that it was made of, and not for one that has taken its place.
bool is_of_record_there(const std::optional<UnitRecord>& row, const std::string& atlas, std::size_t unit) {
  return row && stamp_of_record(atlas, unit) == row->stamp;
}

// What this process has made of a unit may not be its record: another process that did it too may have been first.
std::optional<UnitRecord> record_for_table(const std::string& atlas, std::size_t unit, const StoredPlan& stored,
                                           const std::optional<UnitRecord>& known) {
  if (!known || known->stamp != RecordStamp{}) return known;
  std::optional<UnitRecord> record;
  (void)read_into(record, atlas, unit, stored.id);  // one that is damaged by now is told of when it is read next
  return record;
}

}  // namespace

std::vector<bool> units_with_record(const std::string& atlas, std::size_t units) {
  std::vector<bool> is_there(units);
  for_each_entry(fs::path(atlas) / "units", [&](const fs::path& folder) {
    if (!is_folder_of_records(folder)) return;
    for_each_entry(folder, [&](const fs::path& entry) {
      const std::optional<std::size_t> unit = unit_of_file(entry);
      if (unit && *unit < units) is_there[*unit] = true;
    });
  });
  return is_there;
}

AtlasState read_state(const std::string& atlas, const StoredPlan& stored) {
  const std::vector<FleetUnit>& units = stored.plan.units;
  AtlasState state;
  state.records.resize(units.size());
  const std::vector<bool> is_there = units_with_record(atlas, units.size());
  read_tables(atlas, stored, is_there, state);
  std::vector<std::size_t> there;
  for (std::size_t k = 0; k < units.size(); ++k) {
    if (is_there[k]) there.push_back(k);
  }
  std::vector<std::string> damage(there.size());
  WorkerPool(threads_meant(0)).run(there.size(), kRecordsAtOnce, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      std::optional<UnitRecord>& record = state.records[there[i]];
      if (is_of_record_there(record, atlas, there[i])) continue;
      record.reset();
      damage[i] = read_into(record, atlas, there[i], stored.id);
    }
  });
  std::copy_if(damage.begin(), damage.end(), std::back_inserter(state.damaged),
               [](const std::string& text) { return !text.empty(); });
  return state;
}

AtlasState read_state_of_kept_runs(const std::string& atlas, const StoredPlan& stored) {
  AtlasState state = read_state(atlas, stored);
  std::vector<char> is_lost(state.records.size());
  WorkerPool(threads_meant(0)).run(is_lost.size(), kRecordsAtOnce, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t k = begin; k < end; ++k) {
      const std::optional<UnitRecord>& record = state.records[k];
      if (record && record->is_mapped() && !has_report(atlas, record->run)) is_lost[k] = 1;
    }
  });
  for (std::size_t k = 0; k < is_lost.size(); ++k) {
    if (is_lost[k] == 0) continue;
    state.lost.push_back(std::move(*state.records[k]));
    state.records[k].reset();
  }
  return state;
}

std::string table_path(std::size_t shard) { return fmt::format("shards/{:04}.tsv", shard + 1); }

void write_shard_table(const std::string& atlas, const StoredPlan& stored, std::size_t shard, const AtlasState& state) {
  std::vector<UnitRecord> records;
  for (const std::uint32_t unit : stored.plan.shards.at(shard)) {
    std::optional<UnitRecord> record = record_for_table(atlas, unit, stored, state.records[unit]);
    if (record) records.push_back(std::move(*record));
  }
  if (records.empty()) return;
  const std::string text = records_table(stored.id, records);
  const std::string file = atlas + "/" + table_path(shard);
  require_file_or_nothing(file);
  std::error_code ignored;
  if (fs::exists(file, ignored) && read_text<InputError>(file, kMostTableBytes) == text) return;
  require_same_atlas(atlas, stored);
  make_folder(atlas + "/shards");
  write_file_atomically(file, text);
}

}  // namespace gdtslam
