// gdtslam linkage: properties of a four-bar mount as text, table and drawing; and the design of one.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <cctype>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/drawing/plots/linkage_drawing.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "linkage_table.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

/// Options as text, so that their units can be printed; empty: the default.
struct GoalText {
  std::string swing;
  std::string min_transmission;
  std::string crank;  ///< "3..5cm" or one length
  std::string time_ratio;
  std::string longest;
};

struct LinkageCommand {
  std::string linkage;
  GoalText goal;
  std::size_t count = 1;
  std::string step = "1deg";
  std::string csv;
  std::string picture;
  std::string output;
  bool is_calibrated = false;
  bool lists = false;
  bool designs = false;
  bool force = false;
  bool json = false;
};

constexpr std::string_view kCalibrated = "-calibrated";
constexpr double kLeastStep_deg = 0.001;
constexpr double kMostStep_deg = 90.0;

bool is_preset(std::string_view name) {
  const auto& presets = calib::linkage_presets();
  return std::any_of(presets.begin(), presets.end(), [name](const calib::LinkagePreset& p) { return p.name == name; });
}

calib::SweepModel read_model(const LinkageCommand& command) {
  if (!command.is_calibrated) {
    return resolve_linkage(command.linkage);
  }
  const std::string name = command.linkage + std::string(kCalibrated);
  if (is_preset(name)) {
    return resolve_linkage(name);
  }
  throw UsageError("--calibrated is for the presets paper-a, paper-b and paper-c, not for '" + command.linkage + "'");
}

bool has_unit(const std::string& text) {
  const auto last =
      std::find_if(text.rbegin(), text.rend(), [](unsigned char letter) { return std::isspace(letter) == 0; });
  return last != text.rend() && std::isdigit(static_cast<unsigned char>(*last)) == 0 && *last != '.';
}

// The unit of "5cm": the text after the last digit.
std::string written_unit(const std::string& text) {
  const std::size_t digit = text.find_last_of("0123456789.");
  return digit == std::string::npos ? "" : text.substr(digit + 1);
}

void read_crank(const std::string& text, calib::DesignGoal& goal) {
  constexpr std::string_view kBetween = "..";
  const std::size_t between = text.find(kBetween);
  if (between == std::string::npos) {
    goal.least_crank_m = goal.most_crank_m = quantity_of("--crank", text, Unit::kMetre);
    return;
  }
  std::string least = text.substr(0, between);
  const std::string most = text.substr(between + kBetween.size());
  if (!has_unit(least)) least += written_unit(most);
  goal.least_crank_m = quantity_of("--crank", least, Unit::kMetre);
  goal.most_crank_m = quantity_of("--crank", most, Unit::kMetre);
}

calib::DesignGoal design_goal(const GoalText& text) {
  calib::DesignGoal goal;
  const auto read = [](const char* option, const std::string& words, Unit unit, auto& value) {
    if (!words.empty()) value = quantity_of(option, words, unit);
  };
  read("--swing", text.swing, Unit::kRadian, goal.swing_rad);
  read("--min-transmission", text.min_transmission, Unit::kRadian, goal.min_transmission_rad);
  read("--time-ratio", text.time_ratio, Unit::kNone, goal.time_ratio);
  read("--longest", text.longest, Unit::kMetre, goal.longest_bar_m);
  if (!text.crank.empty()) read_crank(text.crank, goal);
  return goal;
}

// A designed linkage with the presets' other values: lifting is the slow stroke and begins at elevation 0.
calib::SweepModel read_model(const calib::Design& design, std::size_t number) {
  calib::SweepModel model = calib::sweep_model_of_preset(calib::kDefaultLinkage);
  model.name = fmt::format("design-{}", number);
  model.bars = design.bars;
  model.assembly = calib::Assembly::kOpen;
  model.encoder.zero_rad = design.report.lowest.crank_rad;
  model.encoder.direction = design.report.lift_direction;
  model.elevation_sign = 1;
  model.elevation_offset_rad = -design.report.lowest.rocker_rad;
  return model;
}

double csv_step(const std::string& text) {
  const double step_rad = quantity_of("--step", text, Unit::kRadian);
  const double step_deg = deg_from_rad(step_rad);
  if (!(step_deg >= kLeastStep_deg && step_deg <= kMostStep_deg)) {
    throw UsageError(fmt::format("--step: {} is not between {:g} and {:g} deg", text, kLeastStep_deg, kMostStep_deg));
  }
  return step_rad;
}

// All files are written to disk before the first is renamed into place.
void write_files(const LinkageCommand& command, const calib::LinkageCycle& cycle) {
  AtomicFileSet files;
  if (!command.csv.empty()) {
    files.add(command.csv).write(as_csv(cycle.model(), csv_step(command.step)));
  }
  if (!command.picture.empty()) {
    files.add(command.picture).write(drawing_bytes(linkage_drawing(cycle), command.picture, kDensePng));
  }
  if (!command.output.empty()) {
    files.add(command.output).write(linkage_text(cycle.model()));
  }
  files.commit();
}

int list_presets(const LinkageCommand& command) {
  Json all = Json::array();
  std::string text;
  for (const calib::LinkagePreset& preset : calib::linkage_presets()) {
    const bool is_default = preset.name == calib::kDefaultLinkage;
    all.push_back({{"name", preset.name}, {"doc", preset.doc}, {"default", is_default}});
    text += fmt::format("{:<20} {}{}\n", preset.name, preset.doc, is_default ? " (default)" : "");
  }
  print_result(command.json ? json_text(all) : text);
  return static_cast<int>(ExitCode::kDone);
}

std::string designs_table(const std::vector<calib::LinkageCycle>& designs) {
  std::string text = "            crank  coupler   rocker   ground  transmission  time ratio  lift\n";
  for (const calib::LinkageCycle& cycle : designs) {
    const calib::FourBar& bars = cycle.model().bars;
    text += fmt::format("{:<9} {:>7.3f}  {:>7.3f}  {:>7.3f}  {:>7.3f} cm  {:>5.1f} deg  {:>9.3f}  {:>6.1f} deg\n",
                        cycle.model().name, 100.0 * bars.crank_m, 100.0 * bars.coupler_m, 100.0 * bars.rocker_m,
                        100.0 * bars.ground_m, deg_from_rad(cycle.report().value().least_transmission_rad),
                        cycle.report().value().time_ratio, 360.0 * cycle.report().value().lift_share);
  }
  return text;
}

int run_design(const LinkageCommand& command) {
  std::vector<calib::LinkageCycle> designs;
  for (const calib::Design& design : calib::design(design_goal(command.goal), command.count)) {
    designs.emplace_back(read_model(design, designs.size() + 1));
  }
  write_files(command, designs.front());
  if (command.json) {
    Json all = Json::array();
    for (const calib::LinkageCycle& cycle : designs) {
      all.push_back(as_json(cycle));
    }
    print_result(json_text(all));
  } else {
    print_result(designs.size() > 1 ? designs_table(designs) + "\n" + as_text(designs.front())
                                    : as_text(designs.front()));
  }
  if (designs.size() < command.count) {
    print_remark(
        fmt::format("only {} of {}: the goal leaves no more shapes that differ by half a percent of the bars; "
                    "less transmission, a longer bar or a free time ratio leaves more",
                    designs.size(), command.count));
  }
  return static_cast<int>(ExitCode::kDone);
}

void check_files(const LinkageCommand& command) {
  if (!command.picture.empty()) check_drawing_file("--picture", command.picture);
  WrittenFiles written({linkage_file_of(command.linkage)}, command.force);
  written.add("--csv", command.csv);
  written.add("--picture", command.picture);
  written.add("--output", command.output);
}

int run_linkage(const LinkageCommand& command) {
  check_files(command);
  if (command.lists) {
    return list_presets(command);
  }
  if (command.designs) {
    return run_design(command);
  }
  if (command.linkage.empty()) {
    throw UsageError("name a linkage: a preset (gdtslam linkage --list) or a file; or ask for one with --design");
  }
  const calib::LinkageCycle cycle(read_model(command));
  write_files(command, cycle);
  print_result(command.json ? json_text(as_json(cycle)) : as_text(cycle));
  return static_cast<int>(ExitCode::kDone);
}

void add_design_options(CLI::App& command, LinkageCommand& chosen) {
  CLI::Option* const design = command.add_flag("--design", chosen.designs, "Find the bars of a crank-rocker instead");
  const auto add = [&command, design](const char* name, std::string& text, const char* doc, const char* type) {
    command.add_option(name, text, doc)->needs(design)->type_name(type);
  };
  add("--swing", chosen.goal.swing, "Angle that the laser sweeps [90deg]", "ANGLE");
  add("--min-transmission", chosen.goal.min_transmission, "Least transmission angle over the turn [40deg]", "ANGLE");
  add("--crank", chosen.goal.crank, "Length of the crank, or a range of it [3..5cm]", "RANGE");
  add("--time-ratio", chosen.goal.time_ratio, "Slow over quick stroke, met exactly [any: the one that transmits best]",
      "RATIO");
  add("--longest", chosen.goal.longest,
      "Longest bar; longer ones transmit better [4 times the longest crank, at most 1m]", "LENGTH");
  constexpr int kMostDesigns = 100;
  command
      .add_option("--count", chosen.count, "Number of linkages, of different shapes spread over all that meet the goal")
      ->needs(design)
      ->type_name("N")
      ->transform(without_leading_zeros())
      ->check(CLI::Range(1, kMostDesigns))
      ->capture_default_str();
}

}  // namespace

void add_linkage_command(CLI::App& app, CommandContext& context) {
  auto chosen = std::make_shared<LinkageCommand>();
  CLI::App* command = add_command(app, "linkage", "What a nodding mount's four-bar linkage does; designing one");
  CLI::Option* const linkage =
      command->add_option("linkage", chosen->linkage, "A preset (see --list) or a linkage file")->type_name("LINKAGE");
  CLI::Option* const calibrated =
      command->add_flag("--calibrated", chosen->is_calibrated, "The preset's lengths as the paper calibrated them");
  CLI::Option* const list = command->add_flag("--list", chosen->lists, "List the presets")->excludes(linkage);
  calibrated->needs(linkage);
  add_design_options(*command, *chosen);
  command->get_option("--design")->excludes(linkage)->excludes(list);
  command->add_option("--csv", chosen->csv, "Write a table over one turn of the crank")->type_name("FILE");
  command->add_option("--step", chosen->step, "Step of the table's crank angle")
      ->type_name("ANGLE")
      ->capture_default_str();
  command->add_option("--picture,--svg", chosen->picture, "Write a drawing: .svg, .png or .pdf")->type_name("FILE");
  command->add_option("-o,--output", chosen->output, "Write the linkage as a file for map, simulate and calibrate")
      ->type_name("FILE");
  for (const char* name : {"--csv", "--picture", "--output"}) {
    list->excludes(command->get_option(name));
  }
  add_force_option(*command, chosen->force);
  command->add_flag("--json", chosen->json, "Print JSON");
  command->footer(
      "docs/linkage.md explains every figure.\n"
      "\n"
      "Examples:\n"
      "  gdtslam linkage paper-b --picture paper-b.svg\n"
      "  gdtslam linkage paper-a --calibrated --csv turn.csv --step 0.5deg\n"
      "  gdtslam linkage --design --swing 90deg --min-transmission 40deg --crank 3..5cm -o linkage.yaml\n"
      "  gdtslam linkage --design --swing 60deg --min-transmission 30deg --time-ratio 1.2 --count 5 --json");
  command->callback([chosen, &context] { context.run = [chosen] { return run_linkage(*chosen); }; });
}

}  // namespace gdtslam
