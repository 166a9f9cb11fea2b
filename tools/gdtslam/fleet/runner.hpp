// Units of a plan on this machine: a process each, as many at a time as there are processors, the largest first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/runs/fleet/plan.hpp"
#include "engine/runs/fleet/record.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"

namespace gdtslam {

/// How many logs may be refused before a shard counts as failed: a share, of which a part of a log counts as one, or a
/// number.
struct MostRefused {
  std::uint64_t share_nano_percent = 2'000'000'000;  ///< whole: 28 % of 25 logs are 7, and not a little more
  std::size_t count = 0;
  bool is_share = true;
  [[nodiscard]] std::size_t of(std::size_t units) const;
};
/// "2%", "2 %" or "7". Throws UsageError that names the option.
MostRefused parse_most_refused(const std::string& option, const std::string& text);

struct RunnerOptions {
  std::string atlas;
  unsigned processes = 0;  ///< 0: one per processor
  DeviceOptions device;
  bool quiet = false;
};

/// A unit that the machine could not do.
struct UnitFailure {
  std::size_t unit = 0;
  ExitCode code = ExitCode::kFailed;
  std::string message;
};

struct RunnerOutcome {
  std::size_t units = 0;  ///< of the shards
  std::size_t were_done = 0;
  std::size_t mapped = 0;   ///< of the units, now or before
  std::size_t refused = 0;  ///< likewise
  std::vector<UnitFailure> failures{};
};

/// Does what is to do of these shards and writes their tables. What the machine is to blame for is tried once more, and
/// ends the work where it goes on. Throws Error(kInterrupted), with nothing left of the units in hand;
/// Error(kOtherResults); FileError.
RunnerOutcome run_shards(const StoredPlan& stored, const std::vector<std::size_t>& shards,
                         const RunnerOptions& options);

struct ComputedAgain {
  std::vector<UnitRecord> records{};  ///< as they would be, by their units
  std::vector<UnitFailure> failures{};
};
/// Computes units again, apart from the atlas. Throws as run_shards().
ComputedAgain compute_again(const StoredPlan& stored, const std::vector<std::size_t>& units,
                            const RunnerOptions& options);

}  // namespace gdtslam
