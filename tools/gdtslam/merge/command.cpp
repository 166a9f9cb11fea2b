// gdtslam merge: joins the runs of several drives to sites with one map each.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "engine/runs/sites/merge_runs.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

struct MergeCommand {
  MergeRequest request;
  DeviceOptions device;
  bool no_map = false;
  bool no_pictures = false;
  bool json = false;
  bool quiet = false;
};

std::string to_text(const JoinedSite& site) {
  std::string text = fmt::format("{}: {}, {}", printable(site.folder), plural(site.runs.size(), "run"),
                                 plural(site.keyframes, "keyframe"));
  if (site.runs.size() > 1) {
    text += fmt::format(", {} between them", plural(site.loops_between, "loop"));
    if (site.loops_off > 0) text += fmt::format(" and {} that do not hold", site.loops_off);
  }
  text += '\n';
  for (const JoinedRun& run : site.runs) {
    text += fmt::format("  {}  {}\n", printable(run.folder), plural(run.scans, "scan"));
  }
  const MapChanges& changes = site.changes.last;
  if (!changes.empty()) {
    text += fmt::format("  changed between the drives: new in {}, gone in {}\n",
                        plural(count_patches(changes.appeared), "place"), plural(count_patches(changes.gone), "place"));
  }
  return text;
}

// Reports a run that nearly overlaps: its matches did not agree, or fit elsewhere as well.
std::string to_text(const RunSearch& search) {
  const SessionOverlap& overlap = search.search.overlap;
  if (!search.search.edges.empty() || overlap.possible == 0) return {};
  const std::size_t others = search.searched_in.size() - 1;
  const std::string pair =
      fmt::format("not joined: {} and {}{}", printable(search.query), printable(search.searched_in.front()),
                  others == 0 ? "" : " with " + plural(others, "run more"));
  if (search.search.may_lie_elsewhere) return pair + ", which has another part where it may lie as well\n";
  return fmt::format("{}, where {} of {} places were found, {} of them in one spot alone: {}\n", pair, overlap.possible,
                     overlap.fixes.size(), overlap.alone, rule_that_failed({}, overlap));
}

std::string to_text(const SharedRuns& pair) {
  return fmt::format("{} and {} have {} in common, which {} twice: name one of them, unless that is meant\n",
                     printable(pair.run), printable(pair.with), plural(pair.keyframes, "scan"),
                     pair.keyframes == 1 ? "counts" : "count");
}

int merge(const MergeCommand& command) {
  MergeRequest request = command.request;
  if (request.runs.size() < 2) throw UsageError("one run has nothing to be joined with: name two or more");
  WrittenFiles(request.runs, request.replace_foreign_files).add_folder("--output", request.folder);
  request.with_map = !command.no_map;
  request.with_pictures = !command.no_pictures;
  request.stop = [] { return interrupted(); };
  TerminalLine line(command.quiet);
  request.progress = [&line](std::string_view step, double share) {
    line.draw([&](double) { return fmt::format("{:4.0f} %  {}", 100.0 * share, step); });
  };
  BackendWhenNeeded backend(command.device);
  Backend* device = &backend.of(false);
  if (device->device().kind == "cpu") device = nullptr;
  request.threads = command.device.threads;
  const MapperOptions on_failure = on_failure_of(command.device);
  request.options.device = {.get = [&device] { return device; },
                            .lost =
                                [&](const DeviceError& error) {
                                  device = nullptr;
                                  if (!on_failure.fall_back) throw DeviceError(error);
                                  on_failure.warn(std::string(error.what()) + kGoingOnWithCpu);
                                }};
  const MergeOutcome outcome = merge_runs(request);
  line.clear();
  if (command.json) {
    print_result(outcome.report);
    return static_cast<int>(ExitCode::kDone);
  }
  if (command.quiet) return static_cast<int>(ExitCode::kDone);
  std::string text;
  for (const JoinedSite& site : outcome.sites) text += to_text(site);
  for (const RunSearch& search : outcome.searches) text += to_text(search);
  for (const SharedRuns& pair : outcome.shared) text += to_text(pair);
  print_result(text);
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_merge_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<MergeCommand>();
  CLI::App* command = add_command(app, "merge", "Join the runs of several drives: one map where they overlap");
  command->add_option("run", options->request.runs, "Run folders of 'gdtslam map', in any order")
      ->required()
      ->type_name("RUN");
  command
      ->add_option("-o,--output", options->request.folder,
                   "Folder of the results: a run folder for each site, 1, 2 and so on, and merge.json")
      ->required()
      ->type_name("DIR");
  add_force_option(*command, options->request.replace_foreign_files);
  add_device_options(*command, options->device, true, false);
  command->add_flag("--no-map", options->no_map,
                    "Do not cast the occupancy map, nor write map.pgm, map.yaml and the pictures of it");
  command->add_flag("--no-pictures", options->no_pictures, "Do not write overview.png and graph.png");
  command->add_flag("--json", options->json, "Print merge.json on standard output");
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "Which runs overlap is found by itself, without start poses: what the robot saw around places of one run is\n"
      "searched in the whole of the other, with proof. Two runs are joined where three such places agree within 10 cm\n"
      "and 1 degree, nothing speaks against them and they fit nowhere else; runs that overlap with none stay a site "
      "of\n"
      "their own. Then loops between the runs are closed and all keyframes adjusted together.\n"
      "A site is a run folder as 'gdtslam map' writes it, in the frame of its first drive, with session-1.tum,\n"
      "session-2.tum and so on, the path of each run in it. Runs are those of flat lasers that closed their loops.\n"
      "Where a later drive saw through what was a wall earlier, the wall is not in the site; changes.png shows what "
      "is\n"
      "new and gone.\n"
      "\n"
      "Examples:\n"
      "  gdtslam merge monday tuesday wednesday -o site\n"
      "  gdtslam merge runs/* -o sites --threads 0 --json | jq '.sites[].runs[].run'");
  command->callback([options, &context] {
    context.run = [options] { return merge(*options); };
    context.when_out_of_memory = kSmallerMap;
  });
}

}  // namespace gdtslam
