#include "settings.hpp"

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

namespace {

std::vector<Option> options_of(calib::NodTrackLimits& limits) {
  return {{"nod.max_gap", "between two messages of the crank that are further apart its position is not known",
           Unit::kSecond, 0.001, 3600.0, &limits.max_gap_s},
          {"nod.max_turns_per_second", "a crank that seems faster has jumped: not known between the two messages",
           Unit::kNone, 0.01, 1000.0, &limits.max_turns_per_s}};
}

// The options that are no concern of the 2D system.
std::vector<Option> options_besides_mapper(Settings& settings) {
  std::vector<Option> table = options_of(settings.occupancy);
  for (const std::vector<Option>& part : {options_of(settings.nodding), options_of(settings.nod_limits),
                                          options_of(settings.cloud), options_of(settings.log)}) {
    table.insert(table.end(), part.begin(), part.end());
  }
  return table;
}

}  // namespace

std::vector<Option> options_of(Settings& settings) {
  std::vector<Option> table = options_of(settings.mapper);
  const std::vector<Option> others = options_besides_mapper(settings);
  table.insert(table.end(), others.begin(), others.end());
  return table;
}

void require_valid(Settings& settings) {
  std::vector<std::string> faults = validate(settings.mapper);
  for (std::string& fault : violations(options_besides_mapper(settings))) faults.push_back(std::move(fault));
  for (std::string& fault : faults_of(settings.log)) faults.push_back(std::move(fault));
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
