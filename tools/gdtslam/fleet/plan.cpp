// gdtslam fleet plan: which logs, how, in which portions.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>

#include "engine/io/yaml/yaml_text.hpp"
#include "engine/runs/fleet/collect.hpp"
#include "engine/runs/fleet/input.hpp"
#include "engine/runs/fleet/shards.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "fleet.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "node.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {
namespace {

struct PlanOptions {
  std::vector<std::string> logs;
  std::string list;
  std::string atlas;
  SettingsOptions settings;
  RecordingOptions recording;
  std::string linkage;
  std::string get;
  std::uint64_t shards = 0;
  bool lenient = false;
  bool quiet = false;
};

std::vector<FleetUnit> units_of(const PlanOptions& options) {
  constexpr std::size_t kMostListBytes = std::size_t{256} << 20U;
  if (options.logs.empty() && options.list.empty()) throw UsageError("name logs, folders of logs, or --list FILE");
  UnitCollector collector;
  for (const std::string& log : options.logs) collector.add(log);
  if (!options.list.empty()) {
    const std::string name = options.list == "-" ? "standard input" : options.list;
    collector.add_list(read_text<InputError>(options.list, kMostListBytes), name);
  }
  CollectedUnits collected = collector.take();
  if (collected.units.empty()) throw InputError({options.list, 0}, "lists no log");
  if (collected.units.size() > kMostUnits)
    throw InputError(
        fmt::format("{} logs are more than the {} of a plan: make several", collected.units.size(), kMostUnits));
  if (collected.twice > 0)
    print_remark(fmt::format("{} logs are named more than once: each is mapped once", collected.twice));
  if (collected.links > 0)
    print_remark(fmt::format("left out in folders: {} symbolic link{}; name what they lead to", collected.links,
                             collected.links == 1 ? "" : "s"));
  return std::move(collected.units);
}

FleetPlan plan_of(const PlanOptions& options) {
  FleetPlan plan;
  plan.program = this_program();
  Settings settings = load_settings(options.settings);
  state_recording(options.recording, settings.log);
  plan.config = config_text(option_table(settings));
  plan.reading = {options.recording.topics, options.recording.odometry, options.recording.crank,
                  options.recording.mounts, options.lenient};
  if (!options.linkage.empty()) plan.linkage = linkage_text(resolve_linkage(options.linkage));
  plan.get = options.get;
  plan.units = units_of(options);
  for (const FleetUnit& unit : plan.units) {
    if (has_scheme(unit.uri)) (void)get_command(options.get, unit.uri);
  }
  plan.shards =
      packed_shards(plan.units, static_cast<std::size_t>(std::min<std::uint64_t>(options.shards, kMostShards)));
  return plan;
}

std::string bytes_text(std::uint64_t bytes) {
  const double number = static_cast<double>(bytes);
  if (number < 1e9) return fmt::format("{:.1f} MB", 1e-6 * number);
  return number < 1e12 ? fmt::format("{:.1f} GB", 1e-9 * number) : fmt::format("{:.1f} TB", 1e-12 * number);
}

const char* plural(std::size_t count) { return count == 1 ? "" : "s"; }

int make_plan(const PlanOptions& options) {
  if (options.shards > kMostShards)
    throw UsageError(fmt::format("--shards: {} is more than {}", options.shards, kMostShards));
  const FleetPlan plan = plan_of(options);
  const bool is_new = write_plan(options.atlas, plan);
  if (options.quiet) return static_cast<int>(ExitCode::kDone);
  double work_s = 0.0;
  std::uint64_t bytes = 0;
  for (const FleetUnit& unit : plan.units) {
    work_s += estimated_work_s(unit);
    bytes += unit.bytes;
  }
  print_result(fmt::format(
      "{} log{}, {}, in {} shard{}; some {} of a core\n{} {}/{}\n", plan.units.size(), plural(plan.units.size()),
      bytes_text(bytes), plan.shards.size(), plural(plan.shards.size()), time_left_text(work_s),
      is_new ? "planned in" : "the same plan is there already:", printable(options.atlas), kPlanFile));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_fleet_plan(CLI::App& fleet, CommandContext& context) {
  auto options = std::make_shared<PlanOptions>();
  CLI::App* command = add_command(fleet, "plan", "Which logs are mapped, how, and in which portions");
  command
      ->add_option("log", options->logs,
                   "Logs, folders to be searched for them (by the endings of their names; symbolic links in them are\n"
                   "left out), ROS 2 bags, or URIs with a scheme, for --get")
      ->type_name("LOG");
  command
      ->add_option("--list", options->list,
                   "A list of logs: one a line, where its bytes are known with a tab and these; - is standard input")
      ->type_name("FILE");
  command->add_option("-o,--output", options->atlas, "The atlas: a folder that all nodes see, made if need be")
      ->required()
      ->type_name("ATLAS");
  add_settings_options(*command, options->settings);
  add_count_option(*command, "--shards", options->shards, 1,
                   "Portions, at most 1000 [as many as take a core ten minutes each]");
  command
      ->add_option("--get", options->get,
                   "Command that prints the log of an URI with a scheme, {} in its place: 'aws s3 cp {} -'")
      ->type_name("CMD");
  command
      ->add_option("--linkage", options->linkage,
                   "Linkage of nodding lasers, a preset or a file [LOG.linkage.yaml beside each log]")
      ->type_name("NAME|FILE");
  command->add_flag("--lenient", options->lenient, "Count and skip malformed lines instead of refusing the log");
  add_recording_options(*command, options->recording);
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "Writes ATLAS/plan.json, which never changes afterwards: the logs, every option with its value, and the "
      "program.\n"
      "The order in which logs are named does not matter. No log is opened.\n"
      "\n"
      "Examples:\n"
      "  gdtslam fleet plan logs/ -o atlas\n"
      "  gdtslam fleet plan logs/*.bag -o atlas -c fleet.yaml --set map.resolution=\"10 cm\" --shards 40\n"
      "  gdtslam fleet plan --list logs.txt -o atlas --get 'aws s3 cp {} -'");
  command->callback([options, &context] { context.run = [options] { return make_plan(*options); }; });
}

}  // namespace gdtslam
