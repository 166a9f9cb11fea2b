// The parts of `gdtslam fleet`, a sub-command each, and what several of them need.
#pragma once

#include <string>

#include "engine/runs/fleet/plan.hpp"
#include "runner.hpp"
#include "tools/gdtslam/shell/cli.hpp"
#include "tools/gdtslam/shell/commands.hpp"

namespace gdtslam {

void add_fleet_plan(CLI::App& fleet, CommandContext& context);
void add_fleet_run(CLI::App& fleet, CommandContext& context);
void add_fleet_status(CLI::App& fleet, CommandContext& context);
void add_fleet_finish(CLI::App& fleet, CommandContext& context);
void add_fleet_verify(CLI::App& fleet, CommandContext& context);
void add_fleet_submit(CLI::App& fleet, CommandContext& context);
void add_fleet_merge(CLI::App& fleet, CommandContext& context);

/// The positional ATLAS.
void add_atlas(CLI::App& command, std::string& atlas);

/// How units are computed, on the command line.
struct ComputeOptions {
  RunnerOptions runner;
  std::string most_refused = "2%";
};
/// -j, --device, --isa.
void add_compute_options(CLI::App& command, ComputeOptions& options);
/// --max-failed.
void add_most_refused(CLI::App& command, ComputeOptions& options);

/// Exit code of what became of shards, with one line that says why where it is not 0.
int judged(const RunnerOutcome& outcome, const MostRefused& most, const std::string& atlas);

/// Writes atlas.json, summary.csv and index.html; returns the text of atlas.json. Throws InputError
/// where units are missing and `is_partial` is not set, UsageError where another process finishes it; FileError.
std::string finish_atlas(const std::string& atlas, bool is_partial);
/// The hash and the page of a finished atlas, a line each.
std::string finish_text(const std::string& atlas_json, const std::string& atlas);

}  // namespace gdtslam
