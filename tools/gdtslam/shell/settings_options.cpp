#include "settings_options.hpp"

#include <CLI/App.hpp>

#include "gdtslam/io/config_yaml.hpp"

namespace gdtslam {

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

}  // namespace gdtslam
