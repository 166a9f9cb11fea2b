// A small picture of a unit's map for the page of an atlas, in its run folder. Thread-safe; O(cells + poses).
#pragma once

#include <string>

#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// Writes thumbnail.png, or .svg in a build without Cairo: map and path, without words, 320 x 180 at twice as many
/// pixels. Nothing where there is no map or nothing can draw. Throws FileError.
void write_thumbnail(const std::string& run_folder, const MapOutcome& outcome);

/// Its path below the atlas; empty where the run has none.
std::string thumbnail_of(const std::string& atlas, const std::string& run);

}  // namespace gdtslam
