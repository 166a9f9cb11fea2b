#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {

void add_map_command(CLI::App& app, CommandContext& context);
void add_live_command(CLI::App& app, CommandContext& context);
void add_merge_command(CLI::App& app, CommandContext& context);
void add_edit_command(CLI::App& app, CommandContext& context);
void add_fleet_command(CLI::App& app, CommandContext& context);
void add_render_command(CLI::App& app, CommandContext& context);
void add_localize_command(CLI::App& app, CommandContext& context);
void add_doctor_command(CLI::App& app, CommandContext& context);
void add_convert_command(CLI::App& app, CommandContext& context);
void add_evaluate_command(CLI::App& app, CommandContext& context);
void add_calibrate_command(CLI::App& app, CommandContext& context);
void add_linkage_command(CLI::App& app, CommandContext& context);
void add_register_command(CLI::App& app, CommandContext& context);
void add_simulate_command(CLI::App& app, CommandContext& context);
void add_verify_command(CLI::App& app, CommandContext& context);
void add_config_command(CLI::App& app, CommandContext& context);
void add_generate_command(CLI::App& app, CommandContext& context);

namespace {

constexpr const char* kMap = "Map";
constexpr const char* kLook = "Look";
constexpr const char* kMeasure = "Measure and calibrate";
constexpr const char* kResearch = "Research";
constexpr const char* kHere = "This machine and this program";

constexpr CommandRow kCommands[] = {
    {"map", kMap, add_map_command},
    {"live", kMap, add_live_command},
    {"merge", kMap, add_merge_command},
    {"edit", kMap, add_edit_command},
    {"fleet", kMap, add_fleet_command},
#ifdef GDTSLAM_HAS_VIEWER
    {"render", kLook, add_render_command},
#else
    {"render", kLook, nullptr, "GDTSLAM_BUILD_VIEWER"},
#endif
    {"localize", kLook, add_localize_command},
    {"doctor", kLook, add_doctor_command},
    {"convert", kLook, add_convert_command},
    {"evaluate", kMeasure, add_evaluate_command},
#ifdef GDTSLAM_HAS_CALIBRATION
    {"calibrate", kMeasure, add_calibrate_command},
#else
    {"calibrate", kMeasure, nullptr, "GDTSLAM_BUILD_CALIBRATION"},
#endif
    {"linkage", kMeasure, add_linkage_command},
    {"register", kMeasure, add_register_command},
#ifdef GDTSLAM_HAS_SIM
    {"simulate", kResearch, add_simulate_command},
#else
    {"simulate", kResearch, nullptr, "GDTSLAM_BUILD_SIM"},
#endif
    {"verify", kHere, add_verify_command},
    {"config", kHere, add_config_command},
    {"generate", kHere, add_generate_command},
};

constexpr const char* kExamples =
    "Examples:\n"
    "  gdtslam map intel.clf.gz -o intel          map a log; the results are in the folder intel\n"
    "  gdtslam render intel                       a picture of it; films, pages: gdtslam render --help\n"
    "  gdtslam evaluate intel/trajectory.tum --relations intel.relations.gz\n"
    "  gdtslam localize intel today.clf.gz        where a scan was taken in that map, with a proof\n"
    "  gdtslam doctor intel.clf.gz                what is in a log, and what is wrong with it\n"
    "  gdtslam verify --device vulkan             whether a GPU gives the same results as the CPU\n"
    "\n"
    "Exit codes: 0 done; 1 failed while running; 2 wrong usage; 65 bad input data; 69 a device or a part of the\n"
    "program is not available; 74 cannot read or write; 78 bad configuration; 130 interrupted, with what was done\n"
    "written.";

}  // namespace
}  // namespace gdtslam

int main(int argc, char** argv) {
  gdtslam::hold_standard_streams();
  gdtslam::install_interrupt_handlers();
  const gdtslam::Program program{"gdtslam", "2D and 3D mapping with a laser range finder and wheel odometry",
                                 gdtslam::kExamples, gdtslam::kCommands};
  return gdtslam::run_command_line(argc, argv, program, gdtslam::build_stamp());
}
