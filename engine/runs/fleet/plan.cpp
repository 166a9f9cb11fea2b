#include "plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/sha256.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPlanBytes = std::size_t{512} << 20U;
constexpr const char* kPlanAgain = "; plan it again into a new folder: gdtslam fleet plan LOG... -o ATLAS";

// Control characters and what is not ASCII are escaped, so that a terminal shows the file as it is.
std::string one_line_json(const Json& value) { return value.dump(-1, ' ', true); }

template <class Rows, class Row>
std::string lines_of(const Rows& rows, const Row& row) {
  std::string text = "[";
  for (std::size_t k = 0; k < rows.size(); ++k) text += (k == 0 ? "\n  " : ",\n  ") + row(rows[k]);
  return text + "\n ]";
}

Json program_json(const FleetProgram& program) {
  return {{"version", program.version},
          {"sample_map_sha256", program.sample_map_sha256},
          {"sample_trajectory_sha256", program.sample_trajectory_sha256}};
}

Json reading_json(const FleetReading& reading) {
  return {{"topics", reading.topics},
          {"odometry", reading.odometry},
          {"crank", reading.crank},
          {"mounts", reading.mounts},
          {"lenient", reading.lenient}};
}

FleetUnit unit_of(const Json& json) {
  FleetUnit unit{json.at(0).get<std::string>(), 0};
  const Json& bytes = json.at(1);
  if (json.size() != 2 || unit.uri.empty() || !bytes.is_number_unsigned()) throw InputError("has a unit that is none");
  unit.bytes = bytes.get<std::uint64_t>();
  return unit;
}

void require_units(const FleetPlan& plan) {
  if (plan.units.empty() || plan.units.size() > kMostUnits)
    throw InputError(fmt::format("has {} units: one to {} are read", plan.units.size(), kMostUnits));
  const auto is_before = [](const FleetUnit& a, const FleetUnit& b) { return a.uri < b.uri; };
  for (std::size_t k = 1; k < plan.units.size(); ++k) {
    if (!is_before(plan.units[k - 1], plan.units[k])) throw InputError(fmt::format("has unit {} out of order", k));
  }
}

// Every unit in one shard, each shard ascending.
void require_shards(const FleetPlan& plan) {
  if (plan.shards.empty() || plan.shards.size() > kMostShards)
    throw InputError(fmt::format("has {} shards: one to {} are read", plan.shards.size(), kMostShards));
  std::vector<bool> is_there(plan.units.size());
  std::size_t count = 0;
  for (const auto& shard : plan.shards) {
    std::int64_t last = -1;
    for (const std::uint32_t unit : shard) {
      if (unit >= plan.units.size() || unit <= last || is_there[unit])
        throw InputError(fmt::format("has unit {} in a shard where it does not belong", unit));
      is_there[unit] = true;
      last = unit;
      ++count;
    }
  }
  if (count != plan.units.size()) throw InputError("has a unit that is in no shard");
}

// Throws nlohmann's exceptions too.
FleetPlan plan_in(const Json& json) {
  if (json.at("format") != kAtlasFormat) throw InputError("is of another format than this program reads");
  FleetPlan plan;
  const Json& program = json.at("program");
  plan.program = {program.at("version").get<std::string>(), program.at("sample_map_sha256").get<std::string>(),
                  program.at("sample_trajectory_sha256").get<std::string>()};
  plan.config = json.at("config").get<std::string>();
  const Json& reading = json.at("reading");
  plan.reading = {reading.at("topics").get<std::vector<std::string>>(), reading.at("odometry").get<std::string>(),
                  reading.at("crank").get<std::string>(), reading.at("mounts").get<std::vector<std::string>>(),
                  reading.at("lenient").get<bool>()};
  plan.linkage = json.at("linkage").get<std::string>();
  plan.get = json.at("get").get<std::string>();
  const Json& units = json.at("units");
  plan.units.reserve(units.size());
  for (const Json& unit : units) plan.units.push_back(unit_of(unit));
  for (const Json& shard : json.at("shards")) {
    std::vector<std::uint32_t> numbers;
    for (const Json& number : shard) {
      if (!number.is_number_unsigned() || number.get<std::uint64_t>() >= plan.units.size())
        throw InputError("has a number in its shards that is no unit's");
      numbers.push_back(number.get<std::uint32_t>());
    }
    plan.shards.push_back(std::move(numbers));
  }
  require_units(plan);
  require_shards(plan);
  return plan;
}

std::string id_of(std::string_view text) { return Sha256().update(text).hex().substr(0, 16); }

}  // namespace

std::string plan_text(const FleetPlan& plan) {
  std::string text = fmt::format("{{\n \"format\": {},\n", kAtlasFormat);
  const auto add = [&text](const char* key, const Json& value) {
    try {
      text += fmt::format(" \"{}\": {},\n", key, one_line_json(value));
    } catch (const Json::type_error&) {
      throw UsageError(fmt::format("what a plan holds is UTF-8, and its {} is not: {}", key,
                                   value.dump(-1, ' ', true, Json::error_handler_t::replace)));
    }
  };
  add("program", program_json(plan.program));
  add("config", plan.config);
  add("reading", reading_json(plan.reading));
  add("linkage", plan.linkage);
  add("get", plan.get);
  text += " \"units\": " + lines_of(plan.units, [](const FleetUnit& unit) {
            return one_line_json(Json::array({unit.uri, unit.bytes}));
          });
  text += ",\n \"shards\": " + lines_of(plan.shards, [](const auto& shard) { return one_line_json(shard); });
  return text + "\n}\n";
}

FleetPlan parse_plan(std::string_view text, const std::string& name) {
  const Json json = parse_json(text, name, kPlanAgain);
  try {
    return plan_in(json);
  } catch (const Json::exception&) {
    throw InputError({name, 0}, std::string("is damaged: a key is missing or of another kind") + kPlanAgain);
  } catch (const InputError& error) {
    throw InputError({name, 0}, error.what() + std::string(kPlanAgain));
  }
}

StoredPlan read_plan(const std::string& atlas) {
  const std::string file = atlas + "/" + kPlanFile;
  std::error_code ignored;  // what cannot be asked about cannot be read either, which says why
  if (!fs::exists(file, ignored))
    throw FileError(file, "is not there; an atlas begins with: gdtslam fleet plan LOG... -o " + atlas);
  const std::optional<FileState> folder = state_of_file(atlas, S_IFDIR);
  const std::optional<FileState> state = state_of_file(file);
  const std::string text = read_text<InputError>(file, kMostPlanBytes);
  return {.plan = parse_plan(text, file), .id = id_of(text), .folder = folder, .file = state};
}

void require_same_atlas(const std::string& atlas, const StoredPlan& stored) {
  if (!stored.folder) return;
  const std::string file = atlas + "/" + kPlanFile;
  const std::optional<FileState> folder = state_of_file(atlas, S_IFDIR);
  const std::optional<FileState> state = state_of_file(file);
  const bool is_folder = folder && folder->device == stored.folder->device && folder->inode == stored.folder->inode;
  // Who changes its permissions gives the plan another state and leaves its text.
  if (is_folder && state && (state == stored.file || id_of(read_text<InputError>(file, kMostPlanBytes)) == stored.id))
    return;
  throw FileError(atlas, "is no longer the folder that the plan was read from");
}

bool write_plan(const std::string& atlas, const FleetPlan& plan) {
  const std::string file = atlas + "/" + kPlanFile;
  const std::string text = plan_text(plan);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    if (fs::exists(atlas + "/units", ignored))
      throw UsageError(fmt::format("--output: {} has units of a plan that is gone: give a new folder", atlas));
    for (const char* const name :
         {"index.html", "summary.csv", "atlas.json", "runs", "shards", "nodes", "slurm", "staging"}) {
      if (!fs::exists(atlas + "/" + name, ignored)) continue;
      throw UsageError(fmt::format("--output: {} has no plan, but {}, which an atlas would replace: give a new folder",
                                   atlas, name));
    }
    make_folder(atlas);
    AtomicFile written(file);
    written.write(text);
    if (written.commit_unless_there()) return true;
  }
  if (read_text<InputError>(file, kMostPlanBytes) == text) return false;
  throw UsageError(fmt::format("--output: {} has another plan, and a plan never changes: give a new folder", atlas));
}

bool has_scheme(std::string_view uri) {
  const std::size_t end = uri.find("://");
  return end != std::string_view::npos && end > 0 &&
         std::all_of(uri.begin(), uri.begin() + static_cast<int>(end), [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.';
         });
}

}  // namespace gdtslam
