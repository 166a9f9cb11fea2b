// gdtslam reproduce: the paper's figures and tables made anew, as one report with the paper's numbers beside ours.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/io/json_file.hpp"
#include "gdtslam/core/error.hpp"
#include "run.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using OrderedJson = nlohmann::ordered_json;

struct ReproduceCommand {
  reproduce::Options options;
  bool lists = false;
  bool json = false;
};

int list_parts(const ReproduceCommand& command) {
  OrderedJson all = OrderedJson::array();
  std::string text;
  for (const reproduce::PartInfo& info : reproduce::part_list()) {
    all.push_back({{"part", info.id},
                   {"also", info.also.empty() ? OrderedJson() : OrderedJson(info.also)},
                   {"label", info.label},
                   {"title", info.title}});
    text += fmt::format("{:<14} {:<18} {}\n", fmt::format("{}{}{}", info.id, info.also.empty() ? "" : ", ", info.also),
                        info.label, info.title);
  }
  print_result(command.json ? json_text(all) : text);
  return static_cast<int>(ExitCode::kDone);
}

OrderedJson as_json(const reproduce::Result& result) {
  OrderedJson parts = OrderedJson::array();
  for (const reproduce::PartState& state : result.parts) {
    OrderedJson rows = OrderedJson::array();
    if (state.kept) {
      for (const reproduce::Row& row : state.kept->part.rows) {
        rows.push_back({{"quantity", row.quantity},
                        {"paper", row.paper.empty() ? OrderedJson() : OrderedJson(row.paper)},
                        {"ours", row.ours},
                        {"verdict", reproduce::to_string(row.verdict)},
                        {"remark", row.remark}});
      }
    }
    parts.push_back({{"part", state.info->id},
                     {"label", state.info->label},
                     {"made", state.kept.has_value()},
                     {"new", state.is_new},
                     {"cpu_s", state.kept ? OrderedJson(state.kept->cpu_s) : OrderedJson()},
                     {"rows", rows}});
  }
  return {{"html", result.html},
          {"markdown", result.markdown},
          {"version", result.host.version},
          {"device", result.host.device},
          {"processor", result.host.processor},
          {"wall_s", result.wall_s},
          {"parts", parts}};
}

std::string as_text(const reproduce::Result& result) {
  std::string text;
  for (const reproduce::PartState& state : result.parts) {
    const std::string status = !state.kept    ? "not made"
                               : state.is_new ? reproduce::seconds_text(state.kept->cpu_s)
                                              : "kept, made " + state.kept->date;
    text += fmt::format("{:<18} {:<46} {}\n", state.info->label, state.info->title, status);
  }
  const reproduce::VerdictCounts counts = reproduce::counts_of(result);
  return text + fmt::format("{} within what the paper claims, {} outside, {} without a verdict\n{}\n{}\n",
                            counts.within, counts.outside, counts.open, result.html, result.markdown);
}

int run_reproduce(const ReproduceCommand& command) {
  if (command.lists) return list_parts(command);
  reproduce::Options options = command.options;
  if (options.folder.empty()) throw UsageError("say where the report goes: -o DIR");
  options.only = reproduce::checked_ids(options.only);
  if (const char* const data = std::getenv("GDTSLAM_DATA"); options.data.empty() && data != nullptr)
    options.data = data;
  const reproduce::Result result = reproduce::reproduce(options);
  if (command.json) {
    print_result(json_text(as_json(result)));
  } else if (!options.quiet) {
    print_result(as_text(result));
  }
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_reproduce_command(CLI::App& app, CommandContext& context) {
  auto chosen = std::make_shared<ReproduceCommand>();
  reproduce::Options& options = chosen->options;
  options.device.threads = 0;  // as many parts at a time as there are processors
  CLI::App* command = add_command(app, "reproduce", "The paper's figures and tables made anew, as one report");
  command->add_option("-o,--output", options.folder, "Folder of the report; made if need be")->type_name("DIR");
  command->add_option("--only", options.only, "Make these parts only (see --list)")->delimiter(',')->type_name("PARTS");
  command->add_flag("--list", chosen->lists, "List the parts");
  command
      ->add_option("--data", options.data,
                   "Folder of real logs (intel.clf.gz with intel.relations.gz, or slam2d with both), which are added "
                   "to the simulated ones [GDTSLAM_DATA of the environment, else none]")
      ->type_name("DIR");
  command->add_flag("--force", options.force, "Make parts anew that are made already");
  command->add_flag("--keep-runs", options.keep_runs, "Leave the simulated logs and their runs in DIR/work");
  add_device_options(*command, options.device);
  command->add_flag("--json", chosen->json, "Print what was made as JSON");
  command->add_flag("-q,--quiet", options.quiet, "Print errors only");
  command->footer(
      "Writes DIR/report.html, one file that needs nothing else, and DIR/report.md with the pictures in DIR/parts.\n"
      "Parts that are made stay made until the program or their inputs change, so an interrupted run goes on where it\n"
      "was (Ctrl-C: exit 130). docs/howto/reproduce.md says what is held against what.\n"
      "\n"
      "Examples:\n"
      "  gdtslam reproduce -o report\n"
      "  gdtslam reproduce -o report --only fig3,fig11\n"
      "  gdtslam reproduce -o report --data logs --json");
  command->callback([chosen, &context] { context.run = [chosen] { return run_reproduce(*chosen); }; });
}

}  // namespace gdtslam
