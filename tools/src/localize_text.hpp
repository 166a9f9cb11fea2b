// What `gdtslam localize` prints: text for people, JSON for programs. Everything but the JSON's "times" depends on the
// input alone. Thread-safe.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "localize_figures.hpp"
#include "localize_run.hpp"
#include "localize_scans.hpp"

namespace gdtslam {

struct LocalizeTimes {
  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< of all threads
  std::string device{};
};

/// With a reference only scans that are not where it has them are listed, else all.
std::string text_of(const LocalizeJob& job, const Localizer& localizer, const Localized& all);
nlohmann::ordered_json json_of(const LocalizeJob& job, const Localizer& localizer, const Localized& all,
                               const LocalizeTimes& times);

}  // namespace gdtslam
