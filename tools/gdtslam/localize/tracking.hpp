// `gdtslam localize --track`: a robot followed through a log, in a map that stays as it is.
#pragma once

#include "engine/runs/localizer/scans.hpp"
#include "gdtslam/runs/settings.hpp"
#include "options.hpp"

namespace gdtslam {

/// Follows, writes the files, prints; returns the exit code.
int track(const LocalizeOptions& options, const Settings& settings, const LocalizeJob& job);

}  // namespace gdtslam
