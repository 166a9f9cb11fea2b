// A small picture of a map for the page of an atlas. Thread-safe; O(cells + poses).
#pragma once

#include <string>

#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

inline constexpr const char* kThumbnailName = "thumbnail.png";

/// Writes it: map and path, without words, 320 x 180 at twice as many pixels. Does nothing if there is no map or
/// nothing can draw. Throws FileError.
void write_thumbnail(const std::string& folder, const MapOutcome& outcome);

}  // namespace gdtslam
