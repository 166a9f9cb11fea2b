// gdtslam fleet verify: units computed again, here.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/runs/fleet/atlas_hash.hpp"
#include "engine/runs/fleet/kept_run.hpp"
#include "engine/runs/fleet/state.hpp"
#include "fleet.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "node.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

struct VerifyOptions {
  ComputeOptions compute;
  std::string sample = "2%";
  std::uint64_t seed = 1;
};

// Units of other hosts first, in an order that the seed draws.
std::vector<std::size_t> drawn_units(const AtlasState& state, std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> done;
  for (std::size_t k = 0; k < state.records.size(); ++k) {
    if (state.records[k]) done.push_back(k);
  }
  Random random(seed);
  for (std::size_t k = done.size(); k > 1; --k) std::swap(done[k - 1], done[random.below(k)]);
  const std::string here = host_name();
  std::stable_partition(done.begin(), done.end(), [&](std::size_t unit) { return state.records[unit]->host != here; });
  done.resize(std::min(count, done.size()));
  std::sort(done.begin(), done.end());
  return done;
}

std::string difference_of(const UnitRecord& kept, const UnitRecord& again, const std::string& atlas) {
  if (kept.input_sha256 != again.input_sha256) return "the log is another one now";
  if (kept.exit_code != again.exit_code)
    return fmt::format("it ended with exit {}, and here with {} {}", kept.exit_code, again.exit_code, again.reason);
  if (kept.run != again.run) return "its name is another one now";
  if (kept.result_sha256 != again.result_sha256)
    return fmt::format("its result is {} by {} ({}), and {} here", kept.result_sha256.substr(0, 12), kept.host,
                       kept.isa, again.result_sha256.substr(0, 12));
  if (!kept.is_mapped()) return {};
  const std::string folder = atlas + "/" + run_path(kept.run);
  try {
    require_whole_run(folder);
    if (result_sha256_of(folder) == kept.result_sha256) return {};
  } catch (const Error& error) {
    return fmt::format("{} was changed since: {}", folder, said_in_atlas(error.what()));
  }
  return folder + " was changed since";
}

int verify_atlas(const VerifyOptions& options) {
  const RunnerOptions& runner = options.compute.runner;
  const StoredPlan stored = read_plan(runner.atlas);
  const AtlasState state = read_state(runner.atlas, stored);
  const MostRefused sample = parse_most_refused("--sample", options.sample);
  const std::size_t count = sample.of(stored.plan.units.size());
  if (count == 0)
    throw UsageError("--sample: no log would be computed again; give a number from 1, or a share above 0");
  const std::vector<std::size_t> units = drawn_units(state, count, options.seed);
  if (units.empty()) throw InputError(runner.atlas + ": no log is done that could be computed again");
  const ComputedAgain again = compute_again(stored, units, runner);
  std::string differences;
  std::size_t different = 0;
  std::size_t of_others = 0;
  for (const UnitRecord& record : again.records) {
    const UnitRecord& kept = *state.records[record.unit];
    of_others += kept.host != record.host ? 1U : 0U;
    const std::string difference = difference_of(kept, record, runner.atlas);
    if (difference.empty()) continue;
    ++different;
    differences += fmt::format("{} ({}): {}\n", run_path(kept.run), printable(kept.uri), printable(difference));
  }
  if (different > 0) {
    print_result(differences);
    throw Error(ExitCode::kFailed,
                fmt::format("{} of {} logs became something else than in the atlas", different, again.records.size()));
  }
  if (!again.failures.empty()) throw Error(again.failures.front().code, again.failures.front().message);
  if (!runner.quiet)
    print_result(fmt::format("{} logs computed again, {} of them other hosts' work: the same results\n", units.size(),
                             of_others));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_fleet_verify(CLI::App& fleet, CommandContext& context) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command = add_command(fleet, "verify", "Compute a sample of the logs again, and compare");
  add_atlas(*command, options->compute.runner.atlas);
  command->add_option("--sample", options->sample, "Logs that are computed again: a number, or a share of all")
      ->type_name("N|SHARE")
      ->capture_default_str();
  add_count_option(*command, "--seed", options->seed, 0,
                   "Seed of the draw of the logs; those of other hosts come first")
      ->capture_default_str();
  add_compute_options(*command, options->compute);
  command->add_flag("-q,--quiet", options->compute.runner.quiet, "Print errors only");
  command->footer(
      "Compares what a log becomes here with its record and its run folder, of which every file is held against the\n"
      "report; exit 1 with the names where they differ. Nothing is written into the atlas.\n"
      "\n"
      "Examples:\n"
      "  gdtslam fleet verify atlas --sample 2%\n"
      "  gdtslam fleet verify atlas --sample 5 --isa baseline");
  command->callback([options, &context] { context.run = [options] { return verify_atlas(*options); }; });
}

}  // namespace gdtslam
