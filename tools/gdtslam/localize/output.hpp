// What `gdtslam localize` tells: text and a picture for people, JSON for programs. Everything but the JSON's "times"
// depends on the input alone. Thread-safe; the picture takes O(cells).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/runs/localizer/figures.hpp"
#include "engine/runs/localizer/run.hpp"
#include "engine/runs/localizer/scans.hpp"
#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {

struct LocalizeTimes {
  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< of all threads
  std::string device{};
};

/// With a reference only scans that are not where it has them are listed, else all.
std::string as_text(const LocalizeJob& job, const Localizer& localizer, const Localized& all);
nlohmann::ordered_json as_json(const LocalizeJob& job, const Localizer& localizer, const Localized& all,
                               const LocalizeTimes& times);

/// Localised scans on their map: the obstacles in grey, each pose found as an arrow, those that are not where the
/// reference has them in red with a line to it. Pixels, x of the map right, y up.
Canvas localize_picture(const LocalizeJob& job, const Localizer& localizer, const Localized& all);

}  // namespace gdtslam
