// The two parts of `gdtslam fleet`: map the logs, and make one table, page and hash of the results.
#pragma once

#include "tools/gdtslam/shell/cli.hpp"
#include "tools/gdtslam/shell/commands.hpp"

namespace gdtslam {

void add_fleet_run(CLI::App& fleet, CommandContext& context);

}  // namespace gdtslam
