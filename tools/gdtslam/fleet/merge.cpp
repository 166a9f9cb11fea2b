// gdtslam fleet merge: the maps of an atlas joined where they overlap.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <set>

#include "engine/runs/fleet/state.hpp"
#include "engine/runs/sites/merge_runs.hpp"
#include "engine/runs/sites/run_session.hpp"
#include "fleet.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

struct FleetMergeOptions {
  std::string atlas;
  unsigned threads = 0;
  bool no_map = false;
  bool quiet = false;
};

// Run folders of all logs that were mapped, each once, but for those that cannot be joined, of which it tells why.
std::vector<std::string> runs_to_join(const FleetMergeOptions& options) {
  const StoredPlan stored = read_plan(options.atlas);
  const AtlasState state = read_state(options.atlas, stored);
  std::set<std::string> runs;
  for (const auto& record : state.records) {
    if (record && record->is_mapped()) runs.insert(run_path(record->run));
  }
  const auto missing = std::count(state.records.begin(), state.records.end(), std::nullopt);
  if (missing > 0)
    print_remark(fmt::format("{} of {} logs are not done; they are left out", missing, state.records.size()));
  std::vector<std::string> folders;
  for (const std::string& run : runs) {
    try {
      folders.push_back(read_run_session(options.atlas + "/" + run).folder);
    } catch (const InputError& error) {
      print_remark(fmt::format("left out: {}", error.what()));
    }
  }
  return folders;
}

int merge(const FleetMergeOptions& options) {
  MergeRequest request;
  request.runs = runs_to_join(options);
  if (request.runs.size() < 2) {
    throw InputError(fmt::format("{}: {} of its runs can be joined; two or more are needed", options.atlas,
                                 request.runs.empty() ? "none" : "one"));
  }
  request.folder = options.atlas + "/site";
  request.with_map = !options.no_map;
  request.threads = options.threads;
  request.stop = [] { return interrupted(); };
  TerminalLine line(options.quiet);
  request.progress = [&line](std::string_view step, double share) {
    line.draw([&](double) { return fmt::format("{:4.0f} %  {}", 100.0 * share, step); });
  };
  const MergeOutcome outcome = merge_runs(request);
  line.clear();
  if (options.quiet) return static_cast<int>(ExitCode::kDone);
  std::string text = fmt::format("{} runs, {} {}\n", request.runs.size(), outcome.sites.size(),
                                 outcome.sites.size() == 1 ? "site" : "sites");
  for (const JoinedSite& site : outcome.sites) {
    if (site.runs.size() < 2) continue;
    text += fmt::format("{}: {} runs, {} keyframes\n", printable(site.folder), site.runs.size(), site.keyframes);
  }
  print_result(text);
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_fleet_merge(CLI::App& fleet, CommandContext& context) {
  auto options = std::make_shared<FleetMergeOptions>();
  CLI::App* command = add_command(fleet, "merge", "Join the maps where they overlap, as 'gdtslam merge' does");
  add_atlas(*command, options->atlas);
  add_count_option(*command, "--threads", options->threads, 0,
                   "Threads of the CPU, 0 for one per processor. Results do not depend on it")
      ->capture_default_str();
  command->add_flag("--no-map", options->no_map, "No occupancy maps and no pictures of them");
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "Writes ATLAS/site, as 'gdtslam merge' does of all runs of the atlas: a run folder for each site, and "
      "merge.json.\n"
      "One machine does it, and it needs the runs only, not the logs. 'gdtslam fleet finish' links it on the page.\n"
      "\n"
      "Examples:\n"
      "  gdtslam fleet merge atlas\n"
      "  jq '.sites[].runs[].name' atlas/site/merge.json");
  command->callback([options, &context] {
    context.run = [options] { return merge(*options); };
    context.when_out_of_memory = "fewer runs at a time need less: 'gdtslam merge RUN...'";
  });
}

}  // namespace gdtslam
