// What is done of an atlas. A record that is there counts; the tables of shards only spare reading it. Thread-safe; of
// 100,000 units with their tables about half a second, without them a file each, read by all cores.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "plan.hpp"
#include "record.hpp"

namespace gdtslam {

struct AtlasState {
  std::vector<std::optional<UnitRecord>> records;  ///< by unit; nothing: to do
  std::vector<std::string> damaged;                ///< records that cannot be read, a line each; their units are to do
  std::vector<UnitRecord> lost;  ///< of units whose run is gone, by unit; they are to do, and have no record above
};

/// Which units have a record, by a look at the folders. Throws FileError.
std::vector<bool> units_with_record(const std::string& atlas, std::size_t units);

/// The records, whatever became of the runs. Throws FileError.
AtlasState read_state(const std::string& atlas, const StoredPlan& stored);

/// The same, where what was mapped counts only if its run has its report: folders may be lost, as when an atlas comes
/// back from a copy that was not whole. One look more a unit. Throws FileError.
AtlasState read_state_of_kept_runs(const std::string& atlas, const StoredPlan& stored);

/// "shards/0012.tsv".
std::string table_path(std::size_t shard);
/// Writes the table of a shard from the records that it has, unless it is there with the same. Throws FileError.
void write_shard_table(const std::string& atlas, const StoredPlan& stored, std::size_t shard, const AtlasState& state);

}  // namespace gdtslam
