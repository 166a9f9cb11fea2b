#include "record.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "engine/core/files/file_state.hpp"
#include "engine/core/files/folder_calls.hpp"
#include "engine/drawing/letters.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "gdtslam/core/error.hpp"
#include "kept_run.hpp"
#include "plan.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostRecordBytes = std::size_t{1} << 20U;
constexpr std::size_t kUnitsPerFolder = 1000;
constexpr int kTableFormat = 2;  // 1 did not tell which records it was made of
constexpr const char* kDoAgain = "; running its shard again does it anew";
constexpr const char* kNoFile = "is no plain file; remove it and run its shard again";
constexpr std::string_view kHexDigits = "0123456789abcdef";

bool is_hash(const std::string& text, std::size_t digits) {
  return text.size() == digits && text.find_first_not_of(kHexDigits) == std::string::npos;
}

// What names and hashes have to look like before they become part of a path or of a hash.
void require_sound(const UnitRecord& record) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw InputError(std::string("has ") + what + " that is none");
  };
  require(is_hash(record.plan, 16), "a plan");
  require(is_hash(record.run, 16), "a run");
  require(is_hash(record.input_sha256, 64), "an input_sha256");
  require(is_hash(record.result_sha256, record.is_mapped() ? 64 : 0), "a result_sha256");
  require(record.unit < kMostUnits && record.exit_code >= 0 && record.exit_code < 256, "a number");
  const UnitFigures& f = record.figures;
  for (const double value : {f.path_m, f.log_duration_s, f.width_m, f.height_m, record.cpu_s, record.wall_s})
    require(std::isfinite(value), "a number");
}

/// The columns of a table, one visitor for writing and reading.
template <class Record, class Visit>
void for_each_column(Record& record, const Visit& visit) {
  visit(record.unit);
  visit(record.bytes);
  visit(record.input_sha256);
  visit(record.run);
  visit(record.exit_code);
  visit(record.result_sha256);
  visit(record.figures.scans);
  visit(record.figures.doubtful);
  visit(record.figures.keyframes);
  visit(record.figures.path_m);
  visit(record.figures.log_duration_s);
  visit(record.figures.width_m);
  visit(record.figures.height_m);
  visit(record.cpu_s);
  visit(record.wall_s);
  visit(record.host);
  visit(record.isa);
  visit(record.device);
  visit(record.stamp.bytes);
  visit(record.stamp.written_ns);
  visit(record.reason);
  visit(record.uri);
}

/// The words of a line, one after the other.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}
  void operator()(std::string& value) const { value = next(); }
  template <class Number>
  void operator()(Number& value) const {
    const std::string_view word = next();
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    is_sound_ &= code == std::errc{} && end == word.data() + word.size();
  }
  [[nodiscard]] bool is_sound() const { return is_sound_ && is_at_end_; }

 private:
  std::string_view next() const {
    is_sound_ &= !is_at_end_;
    const std::size_t tab = rest_.find('\t');
    const std::string_view word = rest_.substr(0, tab);
    is_at_end_ = tab == std::string_view::npos;
    rest_.remove_prefix(is_at_end_ ? rest_.size() : tab + 1);
    return word;
  }
  mutable std::string_view rest_;
  mutable bool is_sound_ = true;
  mutable bool is_at_end_ = false;
};

std::string header_of(const std::string& plan) {
  return fmt::format("# gdtslam shard {} of plan {}\n", kTableFormat, plan);
}
std::string end_of(std::size_t records) { return fmt::format("# {} records\n", records); }

// One of a run that was lost does not, where the log became another one before it was mapped again.
bool holds_beside(const UnitRecord& there, const UnitRecord& record, const std::string& atlas) {
  if (there.run == record.run)
    return there.exit_code == record.exit_code && there.result_sha256 == record.result_sha256;
  return !there.is_mapped() || has_report(atlas, there.run);
}

UnitRecord record_in(const Json& json) {
  if (json.at("format") != kAtlasFormat) throw InputError("is of another format than this program reads");
  UnitRecord record;
  json.at("plan").get_to(record.plan);
  json.at("uri").get_to(record.uri);
  json.at("input_sha256").get_to(record.input_sha256);
  json.at("run").get_to(record.run);
  json.at("reason").get_to(record.reason);
  json.at("result_sha256").get_to(record.result_sha256);
  json.at("host").get_to(record.host);
  json.at("isa").get_to(record.isa);
  json.at("device").get_to(record.device);
  const auto count = [&json](const char* key, auto& value) {
    if (!json.at(key).is_number_unsigned()) throw InputError(std::string("has no count '") + key + "'");
    json.at(key).get_to(value);
  };
  count("unit", record.unit);
  count("bytes", record.bytes);
  count("exit_code", record.exit_code);
  count("scans", record.figures.scans);
  count("doubtful", record.figures.doubtful);
  count("keyframes", record.figures.keyframes);
  json.at("path_m").get_to(record.figures.path_m);
  json.at("log_duration_s").get_to(record.figures.log_duration_s);
  json.at("width_m").get_to(record.figures.width_m);
  json.at("height_m").get_to(record.figures.height_m);
  json.at("cpu_s").get_to(record.cpu_s);
  json.at("wall_s").get_to(record.wall_s);
  require_sound(record);
  return record;
}

}  // namespace

std::string record_path(std::size_t unit) {
  return fmt::format("units/{:03}/{:06}.json", unit / kUnitsPerFolder, unit);
}

std::string run_path(const std::string& run) { return fmt::format("runs/{}/{}", run.substr(0, 2), run); }

std::string record_text(const UnitRecord& record) {
  const UnitFigures& figures = record.figures;
  return json_text({{"format", kAtlasFormat},
                    {"plan", record.plan},
                    {"unit", record.unit},
                    {"uri", record.uri},
                    {"bytes", record.bytes},
                    {"input_sha256", record.input_sha256},
                    {"run", record.run},
                    {"outcome", record.is_mapped() ? "mapped" : "refused"},
                    {"exit_code", record.exit_code},
                    {"reason", record.reason},
                    {"result_sha256", record.result_sha256},
                    {"scans", figures.scans},
                    {"doubtful", figures.doubtful},
                    {"keyframes", figures.keyframes},
                    {"path_m", figures.path_m},
                    {"log_duration_s", figures.log_duration_s},
                    {"width_m", figures.width_m},
                    {"height_m", figures.height_m},
                    {"cpu_s", record.cpu_s},
                    {"wall_s", record.wall_s},
                    {"host", record.host},
                    {"isa", record.isa},
                    {"device", record.device}});
}

UnitRecord parse_record(std::string_view text, const std::string& name) {
  const Json json = parse_json(text, name, kDoAgain);
  try {
    return record_in(json);
  } catch (const Json::exception&) {
    throw InputError({name, 0}, std::string("is damaged: a key is missing or of another kind") + kDoAgain);
  } catch (const InputError& error) {
    throw InputError({name, 0}, error.what() + std::string(kDoAgain));
  }
}

void require_file_or_nothing(const std::string& file) {
  if (lies_there(file) && !state_of_file(file))
    throw FileError(file, "is no plain file; remove it and give the command again");
}

std::optional<RecordStamp> stamp_of_record(const std::string& atlas, std::size_t unit) {
  const std::optional<FileState> state = state_of_file(atlas + "/" + record_path(unit));
  if (!state) return std::nullopt;
  return RecordStamp{.bytes = state->bytes, .written_ns = state->written_ns};
}

UnitRecord read_record(const std::string& atlas, std::size_t unit) {
  const std::string file = atlas + "/" + record_path(unit);
  const std::optional<RecordStamp> stamp = stamp_of_record(atlas, unit);
  if (!stamp && lies_there(file)) throw InputError({file, 0}, kNoFile);
  UnitRecord record = parse_record(read_text<InputError>(file, kMostRecordBytes), file);
  if (record.unit != unit) throw InputError({file, 0}, std::string("is of another unit") + kDoAgain);
  record.stamp = stamp.value_or(RecordStamp{});
  return record;
}

void write_record(const std::string& atlas, const UnitRecord& record) {
  const std::filesystem::path file = std::filesystem::path(atlas) / record_path(record.unit);
  require_file_or_nothing(file.string());
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored)) {
    try {
      const UnitRecord there = read_record(atlas, record.unit);
      if (there.plan == record.plan && holds_beside(there, record, atlas)) return;
    } catch (const InputError&) {  // torn: it is written anew
    }
  }
  make_folder(file.parent_path().string());
  write_file_atomically(file.string(), record_text(record));
  sync_folder(atlas + "/units");
}

std::string table_text(std::string_view text) {
  std::string clean(text);
  for (char& c : clean) {
    if (static_cast<unsigned char>(c) < 0x20U || c == 0x7F) c = ' ';
  }
  return clean;
}

std::string records_table(const std::string& plan, const std::vector<UnitRecord>& records) {
  std::string text = header_of(plan);
  for (const UnitRecord& record : records) {
    std::string line;
    for_each_column(record, [&line](const auto& value) {
      line += line.empty() ? "" : "\t";
      if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>) {
        line += table_text(value);
      } else {
        line += fmt::format("{}", value);
      }
    });
    text += line + '\n';
  }
  return text + end_of(records.size());
}

std::optional<std::vector<UnitRecord>> parse_records_table(std::string_view text, const std::string& plan) {
  const std::string header = header_of(plan);
  if (!text.starts_with(header) || !is_utf8(text)) return std::nullopt;
  text.remove_prefix(header.size());
  std::vector<UnitRecord> records;
  for (std::size_t end = 0; (end = text.find('\n')) != std::string_view::npos && !text.starts_with('#');) {
    UnitRecord record;
    record.plan = plan;
    const Words words(text.substr(0, end));
    for_each_column(record, words);
    if (!words.is_sound()) return std::nullopt;
    try {
      require_sound(record);
    } catch (const InputError&) {
      return std::nullopt;
    }
    records.push_back(std::move(record));
    text.remove_prefix(end + 1);
  }
  if (text != end_of(records.size())) return std::nullopt;
  return records;
}

}  // namespace gdtslam
