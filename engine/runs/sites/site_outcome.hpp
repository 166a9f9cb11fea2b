// What merging runs gives of one site, as mapping a log gives it: so a site is a run like any other, to be drawn,
// searched in and merged again. Frame: that of the first run's map. Thread-safe; linear in scans and keyframes.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/mapping/sessions/session_merge.hpp"
#include "engine/runs/sites/run_session.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// The path of one run in the site: every scan follows the keyframes before and after it.
Trajectory trajectory_in_site(const RunSession& run, const std::vector<Pose2>& keyframes);

/// Of the site's runs, one after the other. Without what a map has: occupancy and distances from the field.
MapOutcome site_outcome(const MergedSite& site, const std::vector<const RunSession*>& runs,
                        const std::vector<Trajectory>& paths);

/// How far the points of each keyframe lie from the field, in the mean.
std::vector<double> distances_from(const GlobalField& field, const std::vector<const RunSession*>& runs,
                                   const std::vector<std::vector<Pose2>>& poses);

}  // namespace gdtslam
