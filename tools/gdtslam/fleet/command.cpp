// gdtslam fleet: many logs, on one machine or on the nodes of a cluster.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include "engine/io/message_text.hpp"
#include "fleet.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {

void add_atlas(CLI::App& command, std::string& atlas) {
  command.add_option("atlas", atlas, "Folder of the plan and the results, which all nodes see")
      ->required()
      ->type_name("ATLAS");
}

void add_compute_options(CLI::App& command, ComputeOptions& options) {
  command
      .add_option("-j,--jobs", options.runner.processes,
                  "Logs at a time, a process each [SLURM_CPUS_PER_TASK, else one per processor]")
      ->type_name("N")
      ->transform(without_leading_zeros())
      ->check(whole_number_from(1));
  command
      .add_option("--device", options.runner.device.device,
                  "Where to compute: auto, cpu, vulkan or vulkan:N. Results do not depend on it")
      ->type_name("NAME")
      ->capture_default_str();
  offer_words(command.get_option("--device"), {"auto", "cpu", "vulkan"});
  command
      .add_option("--isa", options.runner.device.isa,
                  "Force the CPU's instruction set: baseline, avx2 or avx512. Results do not depend on it")
      ->type_name("NAME");
  offer_words(command.get_option("--isa"), {"baseline", "avx2", "avx512"});
}

void add_most_refused(CLI::App& command, ComputeOptions& options) {
  command
      .add_option("--max-failed", options.most_refused,
                  "Logs that may be refused before this fails (exit 65): a number, or a share of what is run here")
      ->type_name("N|SHARE")
      ->capture_default_str();
}

int judged(const RunnerOutcome& outcome, const MostRefused& most, const std::string& atlas) {
  if (!outcome.failures.empty()) {
    const UnitFailure& first = outcome.failures.front();
    throw Error(first.code,
                fmt::format("{} of {} logs are not done, for what this machine is to blame for; the same command "
                            "goes on: {}",
                            outcome.units - outcome.mapped - outcome.refused, outcome.units, first.message));
  }
  if (outcome.refused > most.of(outcome.units)) {
    throw InputError(
        fmt::format("{} of {} logs were refused, and --max-failed allows {}; 'gdtslam fleet status {}' says why",
                    outcome.refused, outcome.units, most.of(outcome.units), atlas));
  }
  return static_cast<int>(ExitCode::kDone);
}

void add_fleet_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = add_command(app, "fleet", "Map many logs, on one machine or on the nodes of a cluster");
  command->require_subcommand(1);
  add_fleet_plan(*command, context);
  add_fleet_run(*command, context);
  add_fleet_status(*command, context);
  add_fleet_merge(*command, context);
  add_fleet_finish(*command, context);
  add_fleet_verify(*command, context);
  add_fleet_submit(*command, context);
  command->footer(
      "An atlas is a folder: a plan that never changes, a run folder for each log, and a record for each that is "
      "done.\n"
      "Whoever sees the folder can work on it, any number at a time; what is killed is done again, and the results "
      "are\n"
      "the same bytes for any number of nodes and shards.\n"
      "\n"
      "Examples:\n"
      "  gdtslam fleet plan logs/ -o atlas          which logs, how, in which portions\n"
      "  gdtslam fleet submit atlas --engine local  all of it on this machine\n"
      "  gdtslam fleet submit atlas --engine slurm --partition cpu\n"
      "  gdtslam fleet run atlas --shard 3/20       one portion, for any scheduler\n"
      "  gdtslam fleet status atlas\n"
      "  gdtslam fleet merge atlas                  the maps that overlap, joined\n"
      "  gdtslam fleet finish atlas                 one page of all maps, and one hash");
}

}  // namespace gdtslam
