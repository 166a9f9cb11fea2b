#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {

void add_compare_command(CLI::App& app, CommandContext& context);
void add_ablation_command(CLI::App& app, CommandContext& context);
void add_bench_command(CLI::App& app, CommandContext& context);

namespace {

constexpr CommandRow kLabCommands[] = {{"compare", "Commands", add_compare_command},
                                       {"ablation", "Commands", add_ablation_command},
                                       {"bench", "Commands", add_bench_command}};
constexpr const char* kLabExamples =
    "Examples:\n"
    "  gdtslam-lab compare intel.clf.gz\n"
    "  gdtslam-lab ablation intel.clf.gz --relations intel.relations.gz -o ablation.md\n"
    "  gdtslam-lab bench kernel";

}  // namespace
}  // namespace gdtslam

int main(int argc, char** argv) {
  gdtslam::hold_standard_streams();
  gdtslam::install_interrupt_handlers();
  const gdtslam::Program lab{"gdtslam-lab", "Experiments with the mapper: matchers compared, choices left out, times",
                             gdtslam::kLabExamples, gdtslam::kLabCommands};
  return gdtslam::run_command_line(argc, argv, lab, gdtslam::build_stamp());
}
