// The pictures of a run. overview: the view `map` of `gdtslam render`. graph: the loops, and the unreliable stretches.
// Thread-safe; O(cells + pixels + poses).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/drawing/maps/map_pictures.hpp"
#include "engine/runs/drive/map_run.hpp"
#include "engine/runs/folder/loop_files.hpp"
#include "engine/runs/folder/run_folder.hpp"

namespace gdtslam {

/// "office-7f" of "logs/office-7f.log.gz": the title of a run's pictures.
std::string run_title(const std::vector<std::string>& logs);
/// Counts in the subtitle of a picture.
struct RunCounts {
  std::uint64_t scans = 0;
  std::uint64_t keyframes = 0;
  std::uint64_t doubtful = 0;
};
/// "13,631 scans, 2,901 keyframes, 21 doubtful, 522.5 m of path"; without counts of zero. `drives` as for
/// path_length_m().
std::string run_subtitle(const RunCounts& counts, const Trajectory& trajectory, std::span<const std::size_t> drives);
/// "522.5 m"; empty if the robot does not move.
std::string path_length_text(const Trajectory& trajectory, std::span<const std::size_t> drives = {});
/// The occupancy map with the path, as in overview.png; without a size, one that suits the map.
Canvas map_view(const OccupancyMap& map, const PathOverlay& overlay, const MapLook& look,
                const std::optional<PictureSize>& size = {});

/// Overlay of graph_picture() for a run with closed loops.
GraphOverlay graph_overlay(const Trajectory& trajectory, const std::vector<std::size_t>& keyframes,
                           std::span<const ClosedLoop> loops, const std::vector<PoseCovariance>& covariances,
                           std::span<const UncertainStretch> uncertain, const std::vector<std::size_t>& drives);
/// "1 loop on", "23 loops, all on", "20 of 23 loops on", "2 loops switched off", "no loop found".
std::string loops_text(std::size_t found, std::size_t on);
/// "1,803 scans, 20 of 23 loops on; 40 scans not to be trusted, standard deviation up to 0.3 m".
std::string graph_subtitle(std::span<const ClosedLoop> loops, std::span<const UncertainStretch> uncertain,
                           std::uint64_t scans);

/// Writes NAME.png. The run does not need it, so a failure, for lack of a font or of memory, becomes a warning. Throws
/// FileError.
void write_picture(RunFolder& folder, const std::string& name, const Canvas& picture,
                   std::vector<LogReader::Warning>& warnings);
/// True for the kind of such a warning.
bool is_picture_warning(const std::string& kind);

/// Writes overview and graph, as far as the request wants pictures and a map and loops were closed. Throws FileError.
void write_run_pictures(RunFolder& folder, const MapRequest& request, MapOutcome& outcome);

}  // namespace gdtslam
