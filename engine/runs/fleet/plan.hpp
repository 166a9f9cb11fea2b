// plan.json of an atlas: which logs are mapped, how, by what program, and in which portions (docs/formats.md#atlas). It
// is written once and never changes, and is all that nodes have to know. Texts are UTF-8. Thread-safe; linear in the
// units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/files/file_state.hpp"

namespace gdtslam {

inline constexpr const char* kPlanFile = "plan.json";
/// Of plan.json, records, summaries and atlas.json.
inline constexpr int kAtlasFormat = 1;
inline constexpr std::size_t kMostUnits = 500'000;
inline constexpr std::size_t kMostShards = 1000;

/// What tells results of one program from those of another: its version, and what it makes of the sample log.
struct FleetProgram {
  std::string version;
  std::string sample_map_sha256;
  std::string sample_trajectory_sha256;
  friend bool operator==(const FleetProgram&, const FleetProgram&) = default;
};

/// A log to be mapped.
struct FleetUnit {
  std::string uri;          ///< an absolute path, or with a scheme what FleetPlan::get is called with
  std::uint64_t bytes = 0;  ///< 0: nobody knows
  friend bool operator==(const FleetUnit&, const FleetUnit&) = default;
};

/// What is asked of all logs alike besides the configuration: the command line's --topic, --odom, --crank and --mount.
struct FleetReading {
  std::vector<std::string> topics;
  std::string odometry;
  std::string crank;
  std::vector<std::string> mounts;
  bool lenient = false;
  friend bool operator==(const FleetReading&, const FleetReading&) = default;
};

struct FleetPlan {
  FleetProgram program;
  std::string config;  ///< every option with its value, as config.yaml has them
  FleetReading reading;
  std::string linkage;  ///< of nodding lasers, the text of a file; empty: those beside the logs, else the default
  std::string get;      ///< command that prints the log of an URI with a scheme; {} stands for the URI
  std::vector<FleetUnit> units;                    ///< by URI, none twice
  std::vector<std::vector<std::uint32_t>> shards;  ///< numbers of units, ascending; every unit is in one
};

/// The file's text: a unit and a shard a line, ASCII. Throws UsageError where a text of the plan is no UTF-8.
std::string plan_text(const FleetPlan& plan);
/// Back again; `name` stands in messages. Throws InputError with one line where it is damaged or of another format.
FleetPlan parse_plan(std::string_view text, const std::string& name);

/// A plan as it lies in an atlas.
struct StoredPlan {
  FleetPlan plan;
  std::string id;  ///< first 16 hexadecimal digits of the SHA-256 of plan.json: what is of another plan has another
  std::optional<FileState> folder{};  ///< of the atlas as it was before the plan was read; nothing: it lies in none
  std::optional<FileState> file{};    ///< likewise of plan.json
};
/// Throws InputError, and FileError where there is none.
StoredPlan read_plan(const std::string& atlas);

/// An atlas is found by its name, and what is missing in it is made: whoever is about to write into it asks here first
/// whether it is the folder that the plan was read from, with that plan. Throws FileError where it was moved, removed
/// or replaced since.
void require_same_atlas(const std::string& atlas, const StoredPlan& stored);

/// Makes the folder and writes the plan; true where it is new, false where the same one is there already. Throws
/// UsageError where another one is there, or units without a plan; FileError.
bool write_plan(const std::string& atlas, const FleetPlan& plan);

/// Whether text names something that only a command can get: "s3://bucket/a.bag".
bool has_scheme(std::string_view uri);

}  // namespace gdtslam
