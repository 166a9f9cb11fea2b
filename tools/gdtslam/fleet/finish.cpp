// gdtslam fleet finish: one table, one page and one hash of all logs, and what failed.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <memory>
#include <nlohmann/json.hpp>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/fleet/atlas.hpp"
#include "fleet.hpp"
#include "gdtslam/core/error.hpp"
#include "page.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

struct FinishOptions {
  std::string atlas;
  bool json = false;
  bool quiet = false;
};

std::string text_of(const std::vector<FleetRecord>& records, const AtlasSummary& summary, const std::string& atlas) {
  std::string text;
  for (const FleetRecord& record : records) {
    if (record.is_mapped()) continue;
    text += fmt::format("{} {}", printable(record.log), record.outcome);
    text += record.exit_code == 0 ? "\n" : fmt::format(" (exit {}): {}\n", record.exit_code, printable(record.reason));
  }
  text += fmt::format("{}: {} mapped, {} refused, {} failed, {} missing\n", plural(summary.logs, "log"), summary.mapped,
                      summary.refused, summary.failed, summary.missing);
  text += summary.sha256.empty() ? "no hash: logs failed or are missing" : "atlas " + summary.sha256;
  return text + fmt::format("\n{}/index.html\n", printable(atlas));
}

int finish(const FinishOptions& options) {
  const std::vector<FleetRecord> records = read_atlas(options.atlas);
  const AtlasSummary summary = summary_of(records);
  const std::string json = json_text(atlas_json(summary));
  write_file_atomically(options.atlas + "/summary.csv", summary_csv(records));
  write_file_atomically(options.atlas + "/index.html", atlas_page(options.atlas, records, summary));
  write_file_atomically(options.atlas + "/atlas.json", json);
  if (options.json) {
    print_result(json);
  } else if (!options.quiet) {
    print_result(text_of(records, summary, options.atlas));
  }
  if (summary.mapped == summary.logs) return static_cast<int>(ExitCode::kDone);
  throw InputError(
      fmt::format("{} of {} not mapped; summary.csv says why, and the same 'gdtslam fleet run' maps what can be",
                  summary.logs - summary.mapped, plural(summary.logs, "log")));
}

}  // namespace

void add_fleet_finish(CLI::App& fleet, CommandContext& context) {
  auto options = std::make_shared<FinishOptions>();
  CLI::App* command = add_command(fleet, "finish", "One table, one page and one hash of all logs, and what failed");
  command->add_option("atlas", options->atlas, "The folder that 'gdtslam fleet run' wrote")
      ->required()
      ->type_name("ATLAS");
  command->add_flag("--json", options->json, "Print atlas.json on standard output");
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "Writes summary.csv, index.html, a page with a map for each log and what it measured, and atlas.json, and lists "
      "the\n"
      "logs that are not mapped with the reason and the exit code of each; exit 65 if there are any. The hash is that "
      "of\n"
      "all results: the same for any number of machines and shards, any order of the logs, any instruction set and\n"
      "device.\n"
      "\n"
      "Examples:\n"
      "  gdtslam fleet finish atlas\n"
      "  gdtslam fleet finish atlas --json | jq .mapped");
  command->callback([options, &context] { context.run = [options] { return finish(*options); }; });
}

}  // namespace gdtslam
