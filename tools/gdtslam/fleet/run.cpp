// gdtslam fleet run: one portion of a plan.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "engine/runs/fleet/shards.hpp"
#include "fleet.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

struct RunOptions {
  std::string shard;
  ComputeOptions compute;
};

std::optional<std::string> variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

int run_shard(const RunOptions& options) {
  const RunnerOptions& runner = options.compute.runner;
  const MostRefused most = parse_most_refused("--max-failed", options.compute.most_refused);
  const ShardChoice choice = shard_choice(options.shard, variable);
  const StoredPlan stored = read_plan(runner.atlas);
  const std::vector<std::size_t> shards = chosen_shards(choice, stored.plan.shards.size());
  std::vector<std::size_t> numbers(shards.size());
  std::transform(shards.begin(), shards.end(), numbers.begin(), [](std::size_t shard) { return shard + 1; });
  const std::string which = fmt::format("shard {}", fmt::join(numbers, ", "));
  if (!runner.quiet && !choice.said_by.empty())
    print_remark(
        fmt::format("{}: {} of {}", choice.said_by, shards.empty() ? "nothing" : which, stored.plan.shards.size()));
  const RunnerOutcome outcome = run_shards(stored, shards, runner);
  if (!runner.quiet) {
    print_result(fmt::format("{} of {}: {} logs, {} mapped, {} refused{}\n", shards.empty() ? "no shard" : which,
                             stored.plan.shards.size(), outcome.units, outcome.mapped, outcome.refused,
                             outcome.were_done > 0 ? fmt::format("; {} were done already", outcome.were_done) : ""));
  }
  return judged(outcome, most, runner.atlas);
}

}  // namespace

void add_fleet_run(CLI::App& fleet, CommandContext& context) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = add_command(fleet, "run", "Map the logs of one portion; what is done already stays");
  add_atlas(*command, options->compute.runner.atlas);
  command
      ->add_option(
          "--shard", options->shard,
          "Which portion, from 1: I of the plan's own, or I/N (every N-th of them, from the I-th on); auto: as\n"
          "the variables of Slurm, AWS Batch or Kubernetes say")
      ->required()
      ->type_name("I|I/N|auto");
  add_compute_options(*command, options->compute);
  add_most_refused(*command, options->compute);
  command->add_flag("-q,--quiet", options->compute.runner.quiet, "Print errors only");
  command->footer(
      "Before its first log a node maps the sample log, and refuses to work (exit 70) where it becomes something else\n"
      "than in the plan. A log that cannot be mapped is recorded with its reason and stops nothing. Where the machine "
      "is\n"
      "to blame (a disk, a signal, memory), the log is tried once more, left undone, and the exit code is not 0: run "
      "the\n"
      "same shard again. Work is done in SLURM_TMPDIR, TMPDIR or /tmp. An interrupt drops the logs in hand, exit 130.\n"
      "\n"
      "Examples:\n"
      "  gdtslam fleet run atlas --shard 3/20\n"
      "  gdtslam fleet run /shared/atlas --shard auto -j 8");
  command->callback([options, &context] {
    context.run = [options] { return run_shard(*options); };
    context.when_out_of_memory = "fewer at a time (-j) need less";
  });
}

}  // namespace gdtslam
