// gdtslam fleet: maps many logs on one or several machines; one table, page and hash of the results.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/drawing/letters.hpp"
#include "engine/drawing/page/page_writer.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/fleet/atlas.hpp"
#include "engine/runs/fleet/fleet_work.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/fleet/fleet.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using page::Json;

/// Length of the folder that all logs share, which distinguishes none of them.
std::size_t common_folder(const std::vector<FleetRecord>& records) {
  std::string_view common = records.front().log;
  for (const FleetRecord& record : records) {
    const auto [end, other] = std::mismatch(common.begin(), common.end(), record.log.begin(), record.log.end());
    common = common.substr(0, static_cast<std::size_t>(end - common.begin()));
  }
  return common.find_last_of('/') + 1;
}

Json make_row(const std::string& atlas, const FleetRecord& record, const std::string& log) {
  const auto if_there = [&atlas](const std::string& file) {
    std::error_code ignored;
    return fs::exists(atlas + "/" + file, ignored) ? file : std::string();
  };
  const std::size_t name = log.find_last_of('/') + 1;
  return {{"name", legible(log.substr(name))},
          {"folder", legible(log.substr(0, name))},
          {"run", record.run},
          {"picture", if_there(fmt::format("logs/{}/{}", name_in_atlas(record.log), kThumbnailName))},
          {"overview", if_there(record.run + "/overview.png")},
          {"scans", record.scans},
          {"doubtful", record.doubtful},
          {"path_m", record.path_m},
          {"log_duration_s", record.log_duration_s},
          {"width_m", record.width_m},
          {"height_m", record.height_m},
          {"cpu_s", record.cpu_s}};
}

}  // namespace

std::string atlas_page(const std::string& atlas, const std::vector<FleetRecord>& records, const AtlasSummary& summary) {
  Json rows = Json::array();
  Json unmapped = Json::array();
  for (const FleetRecord& record : records) {
    if (record.is_mapped()) {
      rows.push_back(make_row(atlas, record, record.log.substr(common_folder(records))));
    } else {
      unmapped.push_back({legible(record.log), record.outcome, legible(record.reason), record.exit_code});
    }
  }
  page::PageData data;
  data.description = {
      {"title", legible("Atlas " + fs::canonical(atlas).filename().string())},
      {"subtitle", summary.sha256.empty() ? "logs failed or are missing, so there is no hash" : summary.sha256},
      {"atlas", {{"rows", rows}, {"unmapped", unmapped}, {"hosts", summary.hosts}}}};
  // Pictures are beside the page, on disk or on a server.
  return page::page_text(data, "img-src 'self' file: data:");
}

// gdtslam fleet finish: one table, one page and one hash of all logs, with the failures.

namespace {

struct FinishOptions {
  std::string atlas;
  bool json = false;
  bool quiet = false;
};

std::string atlas_text(const std::vector<FleetRecord>& records, const AtlasSummary& summary, const std::string& atlas) {
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
  const AtlasSummary summary = summarise_atlas(records);
  const std::string json = json_text(atlas_json(summary));
  write_file_atomically(options.atlas + "/summary.csv", summary_csv(records));
  write_file_atomically(options.atlas + "/index.html", atlas_page(options.atlas, records, summary));
  write_file_atomically(options.atlas + "/atlas.json", json);
  if (options.json) {
    print_result(json);
  } else if (!options.quiet) {
    print_result(atlas_text(records, summary, options.atlas));
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

// gdtslam fleet: maps many logs on one or several machines.

void add_fleet_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = add_command(app, "fleet", "Map many logs, on one machine or on several");
  command->require_subcommand(1);
  add_fleet_run(*command, context);
  add_fleet_finish(*command, context);
  command->footer(
      "An atlas is a folder with a run folder for each log. A log that is mapped already is skipped, so a command "
      "that\n"
      "was stopped or killed is given once more. The results are the same bytes on any machine, in any number of "
      "shards.\n"
      "\n"
      "Examples:\n"
      "  gdtslam fleet run logs/ -o atlas              all logs on all cores of this machine\n"
      "  gdtslam fleet run logs/ -o atlas --shard 3/20 a part of them, for any scheduler\n"
      "  gdtslam fleet finish atlas                    one table, one page of all maps, and one hash");
}

}  // namespace gdtslam
