// What `gdtslam localize --track` tells: text for people, JSON for programs. Everything but the JSON's "times" depends
// on the input alone. Thread-safe; O(scans).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/runs/localizer/drive.hpp"
#include "engine/runs/localizer/drive_figures.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "output.hpp"

namespace gdtslam {

std::string as_text(const LocalizeJob& job, const Localizer& localizer, const TrackedDrive& drive);
nlohmann::ordered_json as_json(const LocalizeJob& job, const Localizer& localizer, const TrackedDrive& drive,
                               const LocalizeTimes& times);

/// The way of the robot on the map: blue where it was tracked, purple by the wheels, amber where it was only found or
/// may be elsewhere, red where the reference has it elsewhere. Pixels, x of the map right, y up.
Canvas track_picture(const LocalizeJob& job, const Localizer& localizer, const TrackedDrive& drive);

}  // namespace gdtslam
