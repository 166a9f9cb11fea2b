// gdtslam fleet finish: one hash, one table and one page of all logs.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/fleet/record.hpp"
#include "engine/runs/fleet/summary.hpp"
#include "engine/runs/transaction/folder_lock.hpp"
#include "fleet.hpp"
#include "gdtslam/core/error.hpp"
#include "page.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

struct FinishOptions {
  std::string atlas;
  bool is_partial = false;
  bool json = false;
  bool quiet = false;
};

void require_whole(const StoredPlan& stored, const AtlasState& state, const AtlasSummary& summary,
                   const std::string& atlas) {
  if (summary.counts.missing() == 0) return;
  std::size_t first = 0;
  while (state.records[first]) ++first;
  throw InputError(
      fmt::format("{}: {} of {} logs are not done, {} for one; 'gdtslam fleet status {}' names their shards, and "
                  "--partial finishes without them",
                  atlas, summary.counts.missing(), summary.counts.units, stored.plan.units[first].uri, atlas));
}

void name_lost(const StoredPlan& stored, const AtlasState& state, const std::string& atlas) {
  constexpr std::size_t kNamed = 20;
  for (std::size_t k = 0; k < std::min(kNamed, state.lost.size()); ++k) {
    const UnitRecord& record = state.lost[k];
    const auto& shards = stored.plan.shards;
    const auto shard = std::find_if(shards.begin(), shards.end(), [&](const auto& units) {
      return std::binary_search(units.begin(), units.end(), record.unit);
    });
    print_remark(
        fmt::format("{}/{}: is gone, or has no report.json, though {} tells of it; map its log again: "
                    "gdtslam fleet run {} --shard {}",
                    atlas, run_path(record.run), record_path(record.unit), atlas, shard - shards.begin() + 1));
  }
  if (state.lost.size() > kNamed) print_remark(fmt::format("and {} more runs are gone", state.lost.size() - kNamed));
}

int finish(const FinishOptions& options) {
  const std::string text = finish_atlas(options.atlas, options.is_partial);
  if (options.json) {
    print_result(text);
  } else if (!options.quiet) {
    const nlohmann::json json = nlohmann::json::parse(text);
    print_result(fmt::format("{} logs: {} mapped, {} refused, {} missing\n{}", json.at("units").get<std::size_t>(),
                             json.at("mapped").get<std::size_t>(), json.at("refused").get<std::size_t>(),
                             json.at("missing").get<std::size_t>(), finish_text(text, options.atlas)));
  }
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

std::string finish_text(const std::string& atlas_json, const std::string& atlas) {
  const nlohmann::json json = nlohmann::json::parse(atlas_json);
  const auto& hash = json.at("atlas_sha256");
  return fmt::format("{}\n{}/index.html\n",
                     hash.is_null() ? std::string("no hash: logs are missing") : "atlas " + hash.get<std::string>(),
                     printable(atlas));
}

std::string finish_atlas(const std::string& atlas, bool is_partial) {
  const StoredPlan stored = read_plan(atlas);
  const FolderLock lock(atlas);  // from the first record read on: the three files tell of the same ones
  const AtlasState state = read_state_of_kept_runs(atlas, stored);
  const AtlasSummary summary = summary_of(stored, state);
  for (const std::string& damage : state.damaged) print_remark(damage);
  name_lost(stored, state, atlas);
  if (!is_partial) require_whole(stored, state, summary, atlas);
  const nlohmann::ordered_json json = atlas_json(stored, state, summary);
  const auto& hash = json.at("atlas_sha256");
  std::string text = json_text(json);
  require_same_atlas(atlas, stored);
  for (const char* const name : {"/index.html", "/summary.csv", "/atlas.json"}) require_file_or_nothing(atlas + name);
  AtomicFileSet files;
  files.add(atlas + "/index.html")
      .write(atlas_page(atlas, stored, state, summary, hash.is_null() ? std::string() : hash.get<std::string>()));
  files.add(atlas + "/summary.csv").write(summary_csv(stored, state));
  files.add(atlas + "/atlas.json").write(text);
  files.commit();
  return text;
}

void add_fleet_finish(CLI::App& fleet, CommandContext& context) {
  auto options = std::make_shared<FinishOptions>();
  CLI::App* command = add_command(fleet, "finish", "One hash, one table and one page of all logs");
  add_atlas(*command, options->atlas);
  command->add_flag("--partial", options->is_partial, "Finish though logs are not done; there is no hash then");
  command->add_flag("--json", options->json, "Print atlas.json on standard output");
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "Writes atlas.json, summary.csv and index.html, a page with a map for each log, what it measured, and the logs "
      "that\n"
      "were refused with their reasons. The hash is that of all results: the same for any number of nodes and shards, "
      "any\n"
      "order of the logs, any instruction set and device.\n"
      "\n"
      "Examples:\n"
      "  gdtslam fleet finish atlas\n"
      "  gdtslam fleet finish atlas --partial --json | jq .mapped");
  command->callback([options, &context] { context.run = [options] { return finish(*options); }; });
}

}  // namespace gdtslam
