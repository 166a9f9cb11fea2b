#include "settings.hpp"

#include <algorithm>
#include <iterator>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"

namespace gdtslam {

void add_settings_options(CLI::App& command, SettingsOptions& options) {
  command.add_option("-c,--config", options.file, "Configuration (YAML); 'gdtslam config show' lists every option")
      ->type_name("FILE");
  command.add_option("--set", options.sets, "One option, for example --set map.resolution=\"10 cm\"; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
}

std::vector<Option> options_of(Settings& settings) {
  std::vector<Option> table = options_of(settings.mapper);
  std::vector<Option> occupancy = options_of(settings.occupancy);
  std::move(occupancy.begin(), occupancy.end(), std::back_inserter(table));
  return table;
}

void require_valid(Settings& settings) {
  std::vector<std::string> faults = validate(settings.mapper);
  for (std::string& fault : violations(options_of(settings.occupancy))) faults.push_back(std::move(fault));
  std::string all;
  for (const std::string& fault : faults) all += (all.empty() ? "" : "; ") + fault;
  if (!all.empty()) throw ConfigError(all);
}

Settings load_settings(const SettingsOptions& options) {
  Settings settings;
  const std::vector<Option> table = options_of(settings);
  if (!options.file.empty()) settings.from_file = read_config(options.file, table);
  for (const std::string& assignment : options.sets) settings.from_sets.push_back(set_option(table, assignment));
  require_valid(settings);
  return settings;
}

}  // namespace gdtslam
