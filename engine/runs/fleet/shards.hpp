// Portions of a plan: units packed so that each shard is about ten minutes of work for a core, at most 1,000 of them,
// and which shard a node was given. Thread-safe; O(n log n).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plan.hpp"

namespace gdtslam {

/// How long a log takes a core, in seconds: by its bytes and its name alone, so to a factor of some three. 60 s where
/// nobody knows the bytes.
double estimated_work_s(const FleetUnit& unit);

/// The largest unit goes first, each to the shard that has least. `count` 0: as many as make ten minutes each. At most
/// as many as there are units; the same for the same units.
std::vector<std::vector<std::uint32_t>> packed_shards(const std::vector<FleetUnit>& units, std::size_t count);

/// Which part of the work a process does. A plan of another number of shards than `of` is shared out anew: a process
/// does every of-th shard.
struct ShardChoice {
  std::size_t index = 0;          ///< from 0
  std::optional<std::size_t> of;  ///< nothing: as many as the plan has
  std::string said_by;            ///< "SLURM_ARRAY_TASK_ID=3"; empty: the command line
};

/// A variable of the environment, nothing where there is none.
using Environment = std::function<std::optional<std::string>(const char* name)>;

/// "I/N" and "I", both from 1 as people count, or "auto": the variables of Slurm, AWS Batch and Kubernetes. Throws
/// UsageError.
ShardChoice shard_choice(const std::string& text, const Environment& environment);

/// The shards of the plan that the choice means, by number from 0. Throws UsageError where there are none.
std::vector<std::size_t> chosen_shards(const ShardChoice& choice, std::size_t shards);

}  // namespace gdtslam
