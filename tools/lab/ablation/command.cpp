// gdtslam-lab ablation: the effect of each choice of the method on a log with verified relations, as a Markdown table.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <iterator>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/runs/drive/map_run.hpp"
#include "engine/runs/evaluation/errors.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

/// A variant of the method: a list of assignments on top of the configuration.
struct AblationVariant {
  std::string name;
  std::vector<std::string> sets;  ///< path=value
};

std::vector<AblationVariant> default_variants() {
  return {
      {"as configured", {}},
      {"merge (10), (11) as printed", {"merge.rule=literal"}},
      {"κ = 1", {"merge.kappa=1"}},
      {"every scan merged", {"keyframe.every_scan=true"}},
      {"matcher simplex", {"match.matcher=simplex"}},
      {"matcher exhaustive", {"match.matcher=exhaustive"}},
      {"simplex, squared distance, (1) as printed", {"match.matcher=simplex", "match.cost=squared"}},
      {"simplex, nearest cell instead of bilinear", {"match.matcher=simplex", "match.interpolation=nearest"}},
      {"no window search", {"search.when=never"}},
      {"no prior from odometry", {"prior.weight=0"}},
  };
}

struct AblationOptions {
  std::string log;
  std::string relations;
  std::string output;
  std::vector<std::string> variants;  ///< assignments, separated by blanks
  RecordingOptions recording;
  SettingsOptions settings;
  DeviceOptions device;
  ScanRange range;
  bool force = false;
  bool quiet = false;
};

std::vector<std::string> split_words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::vector<AblationVariant> choose_variants(const AblationOptions& options) {
  if (options.variants.empty()) return default_variants();
  std::vector<AblationVariant> variants{{"as configured", {}}};
  for (const std::string& text : options.variants) variants.push_back({text, split_words(text)});
  return variants;
}

Settings make_settings(const AblationOptions& options, const AblationVariant& variant) {
  SettingsOptions chosen = options.settings;
  chosen.sets.insert(chosen.sets.end(), variant.sets.begin(), variant.sets.end());
  return load_settings(chosen);
}

std::string sets_text(const std::vector<std::string>& sets) {
  std::string text;
  for (const std::string& set : sets) text += (text.empty() ? "`" : " `") + set + "`";
  return text;
}

std::string error_text(const ErrorSummary& m, const ErrorSummary& deg) {
  if (m.count == 0) return "-";
  return fmt::format("{:.4f} ± {:.4f} m, {:.3f} ± {:.3f}°", m.mean, m.deviation, deg.mean, deg.deviation);
}

std::string format_row(const AblationVariant& variant, const MapOutcome& outcome, const RelationReport& report) {
  const MapperStatistics& s = outcome.statistics;
  const double rate = outcome.mapper_cpu_s > 0.0 ? static_cast<double>(s.scans) / outcome.mapper_cpu_s : 0.0;
  return fmt::format("| {} | {} | {} | {} | {} | {:.0f} | {} | {} |\n", variant.name, sets_text(variant.sets),
                     error_text(report.all.translation_m, report.all.rotation_deg),
                     error_text(report.short_term.translation_m, report.short_term.rotation_deg),
                     error_text(report.loops.translation_m, report.loops.rotation_deg), rate, s.keyframes, s.doubtful);
}

/// A row of the table; `unmatched`: relations whose stamps are not in the log.
std::string variant_row(const AblationVariant& variant, const AblationOptions& options,
                        const std::vector<Relation>& relations, Backend& backend, std::size_t& unmatched) {
  Settings settings = make_settings(options, variant);
  state_recording(options.recording, settings.log);
  const MapRequest request{.logs = {options.log},
                           .settings = settings,
                           .range = options.range,
                           .with_map = false,
                           .with_loops = false,
                           .on_failure = on_failure_of(options.device)};
  ProgressLine progress("scans, " + variant.name, options.quiet);
  const MapOutcome outcome = MapRun(request, backend)
                                 .run([&progress](std::uint64_t scans, double share) { progress.update(scans, share); },
                                      [] { return interrupted(); });
  if (outcome.interrupted) throw Error(ExitCode::kInterrupted, "interrupted; no table is written");
  const RelationReport report = check_relations(outcome.trajectory, relations, options.relations, options.log).report;
  unmatched = report.unmatched;
  return format_row(variant, outcome, report);
}

int ablation(const AblationOptions& options) {
  if (options.log == "-")
    throw UsageError("ablation reads the log once for each variant: give a file, not standard input");
  WrittenFiles({options.log, options.relations, options.settings.file}, options.force).add("--output", options.output);
  const std::vector<Relation> relations = read_relations(options.relations);
  const std::vector<AblationVariant> variants = choose_variants(options);
  for (const AblationVariant& variant : variants)
    make_settings(options, variant);  // reports misspelt options before the long run
  const std::unique_ptr<Backend> backend = make_backend(options.device);
  std::string table = fmt::format(
      "Mean ± standard deviation of the relation errors on `{}`, no loop closure; scans per core-second inside the "
      "mapper on {} ({}, {} thread{}).\n\n"
      "| variant | options | all relations | short (≤ 20 s) | loops | scans/core-s | keyframes | doubtful |\n"
      "|---|---|---|---|---|---|---|---|\n",
      options.log.substr(options.log.rfind('/') + 1), backend->device().name, backend->device().driver,
      backend->device().threads, backend->device().threads == 1 ? "" : "s");
  if (!options.quiet) print_result(table);
  std::size_t unmatched = 0;  // in the first variant, for the closing line
  for (const AblationVariant& variant : variants) {
    std::string row;
    std::size_t unused = 0;
    const bool is_first = &variant == &variants.front();
    try {
      row = variant_row(variant, options, relations, *backend, is_first ? unmatched : unused);
    } catch (const InputError& error) {
      // The first variant shows whether the log and the relations are usable. If a later variant cannot map the log,
      // that is a result, and its row gives the reason.
      if (is_first) throw;
      row = fmt::format("| {} | {} | failed: {} | | | | | |\n", variant.name, sets_text(variant.sets), error.what());
    }
    if (!options.quiet) print_result(row);
    table += row;
  }
  table +=
      fmt::format("\n{} relations; {} of them have stamps that the log does not have.\n", relations.size(), unmatched);
  write_file_atomically(options.output, table);
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_ablation_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<AblationOptions>();
  CLI::App* command = add_command(app, "ablation", "What each choice of the method is worth on a log, as a table");
  command->add_option("log", options->log, fmt::format("{} log, plain or gzip", kLogFormats))
      ->required()
      ->type_name("LOG");
  command->add_option("--relations", options->relations, "Verified relations of the log, plain or gzip")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", options->output, "The Markdown table to write")->required()->type_name("FILE");
  command
      ->add_option("--variant", options->variants,
                   "Assignments, separated by blanks, that are compared in place of the standard list; may be repeated")
      ->type_name("\"PATH=VALUE ...\"")
      ->allow_extra_args(false);
  add_recording_options(*command, options->recording);
  add_settings_options(*command, options->settings);
  add_device_options(*command, options->device);
  add_count_option(*command, "--skip", options->range.skip, 0, "Leave out the first N scans");
  add_count_option(*command, "--first", options->range.count, 1, "Map N scans only");
  add_force_option(*command, options->force);
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "Every variant maps the whole log with the configuration of -c and --set and its own assignments on top.\n"
      "\n"
      "Examples:\n"
      "  gdtslam-lab ablation intel.clf.gz --relations intel.relations.gz -o ablation.md\n"
      "  gdtslam-lab ablation drive.log --relations drive.relations -o kappa.md --variant merge.kappa=0.25 \\\n"
      "      --variant \"merge.kappa=0.75 merge.threshold=10cm\"");
  command->callback([options, &context] {
    context.run = [options] { return ablation(*options); };
    context.when_out_of_memory = kSmallerMap;
  });
}

}  // namespace gdtslam
