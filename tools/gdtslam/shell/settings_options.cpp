#include "settings_options.hpp"

#include <fmt/format.h>
#include <CLI/App.hpp>

#include "console.hpp"
#include "engine/runs/warning_text.hpp"
#include "gdtslam/io/config_yaml.hpp"

namespace gdtslam {

void add_settings_options(CLI::App& command, SettingsOptions& options) {
  command
      .add_option("-c,--config", options.file, "File of options, YAML; 'gdtslam config show --all' lists every option")
      ->type_name("FILE");
  command
      .add_option("--set", options.sets, "One option, for example --set map.resolution=\"10 cm\"; counts over the file")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
}

Settings load_settings(const SettingsOptions& options) {
  Settings settings;
  const std::vector<Option> table = option_table(settings);
  if (!options.file.empty()) settings.from_file = read_config(options.file, table);
  for (const std::string& assignment : options.sets) settings.from_sets.push_back(set_option(table, assignment));
  require_valid(settings);
  return settings;
}

void print_warnings(const std::vector<LogReader::Warning>& warnings) {
  for (const LogReader::Warning& warning : warnings) print_remark(warning_text(warning));
}

std::string doubts_text(const MapOutcome& outcome, const std::string& folder) {
  if (outcome.doubtful.empty()) return {};
  const std::size_t count = outcome.doubtful.size();
  std::string text = fmt::format("{} of {} scans {} doubtful", count, scans_of(outcome), count == 1 ? "is" : "are");
  if (!folder.empty()) text += fmt::format("; 'gdtslam doctor --after {}' says where to look", folder);
  return text;
}

void print_remarks(const MapOutcome& outcome, const std::string& folder) {
  print_warnings(outcome.warnings);
  for (const LogFinding& finding : outcome.findings) print_remark(finding_text(finding));
  const std::string doubts = doubts_text(outcome, folder);
  if (!doubts.empty()) print_remark(doubts);
}

}  // namespace gdtslam
