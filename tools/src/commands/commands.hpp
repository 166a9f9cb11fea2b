// The sub-commands of `gdtslam`. Each adds its options to the command line; when it was chosen, the parser leaves in
// the context what to run. The functions only register: nothing is read or written while the command line is parsed.
#pragma once

#include <functional>

#include <CLI/App.hpp>

namespace gdtslam {

/// What the command line asked for.
struct CommandContext {
  std::function<int()> run;  ///< the chosen sub-command; returns the exit code
  const char* when_out_of_memory = "it needs less data at a time or more memory";  ///< what to do then
};

/// Of the commands that make maps.
inline constexpr const char* kSmallerMap =
    "a smaller map.max_megacells or cloud.max_megavoxels, or a larger map.resolution needs less";

void add_map_command(CLI::App& app, CommandContext& context);
void add_simulate_command(CLI::App& app, CommandContext& context);
void add_linkage_command(CLI::App& app, CommandContext& context);
void add_calibrate_command(CLI::App& app, CommandContext& context);
void add_measure_command(CLI::App& app, CommandContext& context);
void add_evaluate_command(CLI::App& app, CommandContext& context);
void add_render_command(CLI::App& app, CommandContext& context);
void add_reproduce_command(CLI::App& app, CommandContext& context);
void add_localize_command(CLI::App& app, CommandContext& context);
void add_doctor_command(CLI::App& app, CommandContext& context);
void add_config_command(CLI::App& app, CommandContext& context);
void add_devices_command(CLI::App& app, CommandContext& context);
void add_verify_command(CLI::App& app, CommandContext& context);
void add_bench_command(CLI::App& app, CommandContext& context);
void add_ablation_command(CLI::App& app, CommandContext& context);
void add_compare_command(CLI::App& app, CommandContext& context);

}  // namespace gdtslam
