// The pictures of a run: overview, the map with the path; graph, where loops hold the path and where it is not to be
// trusted. Thread-safe; O(cells + pixels + poses).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/drawing/maps/graph_picture.hpp"
#include "engine/runs/folder/loops_report.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/mapping/map_run.hpp"

namespace gdtslam {

/// What graph_picture() shows of a run with closed loops.
GraphOverlay graph_overlay(const Trajectory& trajectory, const std::vector<std::size_t>& keyframes,
                           std::span<const ClosedLoop> loops, const std::vector<PoseCovariance>& covariances,
                           std::span<const UncertainStretch> uncertain, const std::vector<std::size_t>& drives);
/// "1 loop on", "23 loops, all on", "20 of 23 loops on", "2 loops switched off", "no loop found".
std::string loops_text(std::size_t found, std::size_t on);
/// "1,803 scans, 20 of 23 loops on; 40 scans not to be trusted, standard deviation up to 0.3 m".
std::string graph_subtitle(std::span<const ClosedLoop> loops, std::span<const UncertainStretch> uncertain,
                           std::uint64_t scans);

/// NAME.png; NAME.svg where this build makes no pixels or they fail, for want of a font or of memory; neither where
/// that fails too. The run is as good without: each failure is one of the warnings. Throws FileError.
void write_picture(RunFolder& folder, const std::string& name, const Canvas& picture,
                   std::vector<LogReader::Warning>& warnings);

/// Both, as far as the job wants pictures and a map, and loops were closed; old ones go. Throws FileError.
void write_run_pictures(RunFolder& folder, const MapJob& job, MapOutcome& outcome);

}  // namespace gdtslam
