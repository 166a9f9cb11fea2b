#include "settings_options.hpp"

#include <fmt/format.h>
#include <CLI/App.hpp>

#include "console.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/io/config_yaml.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostDoubtsShown = 5;

std::string as_text(const DoubtfulScan& scan) {
  const std::string what = scan.accepted
                               ? fmt::format("the match is taken, {:.3f} m and {:.1f} deg from the prediction",
                                             scan.from_prediction_m, deg_from_rad(scan.from_prediction_rad))
                               : "the prediction is taken";
  return fmt::format("doubtful scan {} at {:.6f} s: {}; {}", scan.index, scan.stamp_s, to_string(scan.reason), what);
}

}  // namespace

void add_settings_options(CLI::App& command, SettingsOptions& options) {
  command.add_option("-c,--config", options.file, "Configuration (YAML); 'gdtslam config show' lists every option")
      ->type_name("FILE");
  command.add_option("--set", options.sets, "One option, for example --set map.resolution=\"10 cm\"; may be repeated")
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
  for (const LogReader::Warning& warning : warnings) {
    print_remark(fmt::format("warning: {} ({} times; first: {})", warning.kind, warning.count, warning.first));
  }
}

void print_remarks(const MapOutcome& outcome) {
  print_warnings(outcome.warnings);
  for (std::size_t k = 0; k < outcome.doubtful.size() && k < kMostDoubtsShown; ++k) {
    print_remark(as_text(outcome.doubtful[k]));
  }
  if (outcome.doubtful.size() > kMostDoubtsShown) {
    print_remark(
        fmt::format("and {} more doubtful scans; report.json lists all", outcome.doubtful.size() - kMostDoubtsShown));
  }
}

}  // namespace gdtslam
