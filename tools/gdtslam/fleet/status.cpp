// gdtslam fleet status: what is done of an atlas.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/io/json_file.hpp"
#include "engine/runs/fleet/summary.hpp"
#include "fleet.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

struct StatusOptions {
  std::string atlas;
  bool json = false;
};

std::string counts_text(const AtlasCounts& counts) {
  return fmt::format("{} mapped, {} refused, {} missing", counts.mapped, counts.refused, counts.missing());
}

std::string reasons_text(const AtlasSummary& summary) {
  std::vector<std::pair<std::size_t, std::string>> reasons;
  for (const auto& [reason, count] : summary.reasons) reasons.emplace_back(count, reason);
  std::stable_sort(reasons.begin(), reasons.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  constexpr std::size_t kShown = 20;
  std::string text;
  for (std::size_t k = 0; k < std::min(kShown, reasons.size()); ++k)
    text += fmt::format("  {:>6}  {}\n", reasons[k].first, printable(reasons[k].second));
  if (reasons.size() > kShown) text += fmt::format("  and {} more reasons\n", reasons.size() - kShown);
  return text.empty() ? text : "refused because the log\n" + text;
}

std::string lost_text(const AtlasState& state) {
  if (state.lost.empty()) return {};
  return fmt::format(
      "{} of the missing have a record, but their run folders are gone or have no report; running their shards again "
      "maps them anew, once what is left of such folders is removed\n",
      state.lost.size());
}

// Shards that are done say nothing new.
std::string shards_text(const AtlasSummary& summary) {
  constexpr std::size_t kShown = 20;
  std::string text;
  std::size_t left = 0;
  for (std::size_t k = 0; k < summary.shards.size(); ++k) {
    if (summary.shards[k].missing() == 0) continue;
    if (++left <= kShown) text += fmt::format("  {:>6}  {}\n", k + 1, counts_text(summary.shards[k]));
  }
  if (left > kShown) text += fmt::format("  and {} more\n", left - kShown);
  return text.empty() ? text : fmt::format("{} of {} shards are not done\n", left, summary.shards.size()) + text;
}

std::string slowest_text(const StoredPlan& stored, const AtlasState& state, const AtlasSummary& summary) {
  constexpr std::size_t kShown = 3;
  std::string text;
  for (std::size_t k = 0; k < std::min(kShown, summary.slowest.size()); ++k) {
    const std::size_t unit = summary.slowest[k];
    text += fmt::format("  {:>6.1f} s  {}\n", state.records[unit]->cpu_s, printable(stored.plan.units[unit].uri));
  }
  return text.empty() ? text : "the slowest, CPU time\n" + text;
}

int status(const StatusOptions& options) {
  const StoredPlan stored = read_plan(options.atlas);
  const AtlasState state = read_state_of_kept_runs(options.atlas, stored);
  const AtlasSummary summary = summary_of(stored, state);
  if (options.json) {
    print_result(json_text(status_json(stored, state, summary)));
    return static_cast<int>(ExitCode::kDone);
  }
  for (const std::string& damage : state.damaged) print_remark(damage);
  print_result(fmt::format("{}: {} logs in {} shards, {}\n", printable(options.atlas), summary.counts.units,
                           summary.shards.size(), counts_text(summary.counts)) +
               lost_text(state) + shards_text(summary) + reasons_text(summary) + slowest_text(stored, state, summary));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_fleet_status(CLI::App& fleet, CommandContext& context) {
  auto options = std::make_shared<StatusOptions>();
  CLI::App* command = add_command(fleet, "status", "What is done, refused and missing");
  add_atlas(*command, options->atlas);
  command->add_flag("--json", options->json, "Print JSON");
  command->footer("Examples:\n  gdtslam fleet status atlas\n  gdtslam fleet status atlas --json | jq .missing");
  command->callback([options, &context] { context.run = [options] { return status(*options); }; });
}

}  // namespace gdtslam
