// gdtslam fleet: many logs, on one machine or on several.
#include <CLI/App.hpp>

#include "fleet.hpp"

namespace gdtslam {

void add_fleet_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = add_command(app, "fleet", "Map many logs, on one machine or on several");
  command->require_subcommand(1);
  add_fleet_run(*command, context);
  add_fleet_finish(*command, context);
  command->footer(
      "An atlas is a folder with a run folder for each log. A log that is mapped already is skipped, so a command "
      "that\n"
      "was stopped or killed is given once more. The results are the same bytes on any machine, in any number of "
      "shards.\n"
      "\n"
      "Examples:\n"
      "  gdtslam fleet run logs/ -o atlas              all logs on all cores of this machine\n"
      "  gdtslam fleet run logs/ -o atlas --shard 3/20 a part of them, for any scheduler\n"
      "  gdtslam fleet finish atlas                    one table, one page of all maps, and one hash");
}

}  // namespace gdtslam
