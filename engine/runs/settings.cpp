#include "gdtslam/runs/settings.hpp"

#include "gdtslam/core/error.hpp"

namespace gdtslam {

namespace {

std::vector<Option> option_table(calib::NodTrackLimits& limits) {
  return {{"nod.max_gap", "between two messages of the crank that are further apart its position is not known",
           Unit::kSecond, 0.001, 3600.0, &limits.max_gap_s},
          {"nod.max_turns_per_second", "a crank that seems faster has jumped: not known between the two messages",
           Unit::kNone, 0.01, 1000.0, &limits.max_turns_per_s}};
}

// The options that are no concern of the 2D system.
std::vector<Option> options_besides_mapper(Settings& settings) {
  std::vector<Option> table = option_table(settings.occupancy);
  for (const std::vector<Option>& part : {option_table(settings.nodding), option_table(settings.nod_limits),
                                          option_table(settings.cloud), option_table(settings.log)}) {
    table.insert(table.end(), part.begin(), part.end());
  }
  return table;
}

}  // namespace

std::vector<Option> option_table(Settings& settings) {
  std::vector<Option> table = option_table(settings.mapper);
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

}  // namespace gdtslam
