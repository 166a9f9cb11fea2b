// Changes in a site between its drives. Readings of things that a later drive saw to be gone are removed from the scans
// for the map, so that no map of the site shows them. Frame: the site's. Thread-safe; linear in the beams of all
// keyframes.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/drawing/maps/map_pictures.hpp"
#include "engine/mapping/changes/map_changes.hpp"
#include "engine/mapping/sites/session_merge.hpp"
#include "engine/runs/sites/run_session.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/occupancy.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// A drive of a site's runs. A site that is merged again has several drives.
struct SiteDrive {
  std::size_t run = 0;  ///< index in the site
  std::string folder;   ///< folder of that run
  std::size_t first_keyframe = 0;
  std::size_t end_keyframe = 0;
  double first_s = 0.0;  ///< stamps of its scans
  double last_s = 0.0;
};

struct SiteChanges {
  double resolution_m = 0.0;
  std::vector<SiteDrive> drives;
  std::vector<MapChanges> by_drive;  ///< cells count from the frame's origin
  MapChanges last;                   ///< state after all drives: new cells, and cells that are gone
  std::size_t readings = 0;          ///< readings removed
};

/// Finds the changes, and removes readings of things that are gone from the runs' keyframes.
SiteChanges take_out_changes(const MergedSite& site, const std::vector<RunSession*>& runs);

/// For changes.png of the site.
Canvas draw_changes_picture(const SiteChanges& changes, const OccupancyMap& map, const MergedSite& site,
                            const std::vector<const RunSession*>& runs);

/// For merge.json: the changes of each drive, in the order of the site's runs.
nlohmann::ordered_json changes_json(const SiteChanges& changes);

// Outcome of one site of a merge, like that of mapping a log. So a site is a run like any other and can be drawn,
// searched and merged again. Frame: the first run's map. Thread-safe; linear in scans and keyframes.

/// The path of one run in the site: every scan moves with the keyframes before and after it.
Trajectory trajectory_in_site(const RunSession& run, const std::vector<Pose2>& keyframes);

/// Outcome of the site's runs, one after the other, without occupancy and distances from the field.
MapOutcome site_outcome(const MergedSite& site, const std::vector<const RunSession*>& runs,
                        const std::vector<Trajectory>& paths);

/// Mean distance of each keyframe's points to the obstacles of the field.
std::vector<double> distances_from(const GlobalField& field, const std::vector<const RunSession*>& runs,
                                   const std::vector<std::vector<Pose2>>& poses);

}  // namespace gdtslam
