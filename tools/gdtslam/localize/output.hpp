// Output of `gdtslam localize`: text and a picture for people, JSON for programs. Everything but the JSON's
// "times" depends on the input alone. Thread-safe; O(scans), a picture O(cells).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/runs/localizer/drive.hpp"
#include "engine/runs/localizer/run.hpp"
#include "engine/runs/localizer/scans.hpp"
#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam {

struct LocalizeTimes {
  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< of all threads
  std::string device{};
};

std::string as_text(const Localizer& localizer, const Localized& all);
std::string as_text(const Localizer& localizer, const TrackedDrive& drive);
nlohmann::ordered_json as_json(const LocalizeJob& job, const Localizer& localizer, const Localized& all,
                               const LocalizeTimes& times);
nlohmann::ordered_json as_json(const LocalizeJob& job, const Localizer& localizer, const TrackedDrive& drive,
                               const LocalizeTimes& times);

/// "196 found, 4 ambiguous, 0 poor fit"; scans without a pose where there are any.
std::string verdicts_text(const std::vector<LocalizedScan>& scans);

/// Scans on their map, each as an arrow; the way of a robot that was followed.
Canvas localize_picture(const std::string& log, const Localizer& localizer, const Localized& all);
Canvas localize_picture(const std::string& log, const Localizer& localizer, const TrackedDrive& drive);

}  // namespace gdtslam
