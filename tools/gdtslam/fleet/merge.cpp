// gdtslam fleet merge: the maps of an atlas joined where they overlap.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include "engine/runs/fleet/kept_run.hpp"
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

// Run folders of all logs that were mapped, but for those that cannot be joined, of which it tells why. A drive whose
// log was kept twice, plain and packed, has two, of which one is joined.
std::vector<std::string> runs_to_join(const FleetMergeOptions& options) {
  const StoredPlan stored = read_plan(options.atlas);
  const AtlasState state = read_state_of_kept_runs(options.atlas, stored);
  std::map<std::string, std::string> runs;  // with a log that became each
  for (const auto& record : state.records) {
    if (record && record->is_mapped()) runs.emplace(run_path(record->run), record->uri);
  }
  const auto missing = std::count(state.records.begin(), state.records.end(), std::nullopt);
  if (missing > 0)
    print_remark(fmt::format("{} of {} logs are not done; they are left out", missing, state.records.size()));
  std::vector<std::string> folders;
  std::map<std::string, std::string> log_of_drive;
  for (const auto& [run, log] : runs) {
    try {
      const RunSession session = read_run_session(options.atlas + "/" + run);
      const auto [drive, is_new] = log_of_drive.emplace(session.keyframes_sha256, log);
      if (is_new) {
        folders.push_back(session.folder);
      } else {
        print_remark(fmt::format("left out: {}: {} is the same drive as {}, whose run is joined", session.folder, log,
                                 drive->second));
      }
    } catch (const InputError& error) {
      print_remark("left out: " + said_in_atlas(error.what()));
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
  std::string text = fmt::format("{}, {}\n", plural(request.runs.size(), "run"), plural(outcome.sites.size(), "site"));
  for (const JoinedSite& site : outcome.sites) {
    if (site.runs.size() < 2) continue;
    text += fmt::format("{}: {}, {}\n", printable(site.folder), plural(site.runs.size(), "run"),
                        plural(site.keyframes, "keyframe"));
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
