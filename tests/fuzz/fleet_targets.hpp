// What many processes leave in the folder of an atlas, and the list of logs that it began with.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "engine/io/sha256.hpp"
#include "engine/runs/fleet/collect.hpp"
#include "engine/runs/fleet/plan.hpp"
#include "engine/runs/fleet/shards.hpp"
#include "engine/runs/fleet/state.hpp"
#include "engine/runs/fleet/summary.hpp"
#include "run_folder_targets.hpp"
#include "target.hpp"

namespace gdtslam::fuzz {

/// A list of logs: its units have their places in the shards, and a plan of them reads back. Lines of files are left
/// out, which would be those of this machine; with a number of bytes behind it a file is not looked at.
inline void read_fleet_list(std::span<const std::byte> data) {
  std::string list;
  for (std::string_view rest = text_of(data); !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    if (line.find('\t') != std::string_view::npos || has_scheme(line)) list.append(line) += '\n';
  }
  expect_typed<InputError, FileError>([&] {
    UnitCollector collector;
    collector.add_list(list, "fuzz");
    CollectedUnits collected = collector.take();
    if (collected.units.empty()) return;
    FleetPlan plan;
    plan.units = std::move(collected.units);
    plan.shards = packed_shards(plan.units, data.size() % 5);
    for (const FleetUnit& unit : plan.units) require(estimated_work_s(unit) > 0.0);
    require(parse_plan(plan_text(plan), "written").units == plan.units);
  });
}

/// The plan comes first, then records and the table of the first shard, which stands for records that it has; they are
/// of the plan PLANID. Whatever they are, each unit counts once, and what is said of the whole adds up.
inline void read_atlas(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  static const bool is_ready = std::filesystem::create_directories(folder.file("units/000")) &&
                               std::filesystem::create_directory(folder.file("shards"));
  require(is_ready);
  constexpr std::array<std::string_view, 4> kNames{"plan.json", "units/000/000000.json", "units/000/000001.json",
                                                   "shards/0001.tsv"};
  auto files = files_in(text_of(data), std::string(kNames[0]));
  const std::string id = Sha256().update(std::string_view(files["plan.json"])).hex().substr(0, 16);
  for (auto& [name, text] : files) {
    if (name != kNames[0]) detail::replace_all(text, "PLANID", id);
  }
  put_files(folder, files, kNames);
  expect_typed<InputError>([&] {
    const StoredPlan stored = read_plan(folder.path());
    const std::size_t units = stored.plan.units.size();
    const AtlasState state = read_state(folder.path(), stored);
    require(state.records.size() == units);
    const AtlasSummary summary = summary_of(stored, state);
    require(summary.counts.units == units && summary.counts.mapped + summary.counts.refused <= units);
    std::size_t in_shards = 0;
    for (const AtlasCounts& shard : summary.shards) in_shards += shard.units;
    require(in_shards == units);
    require(status_json(stored, state, summary).dump(-1, ' ', true).find('\n') == std::string::npos);
    require(atlas_json(stored, state, summary).is_object() && !summary_csv(stored, state).empty());
  });
}

inline constexpr std::array kFleetTargets{FuzzTarget{"fleet_list", read_fleet_list, 3},
                                          FuzzTarget{"atlas", read_atlas, 3}};

}  // namespace gdtslam::fuzz
