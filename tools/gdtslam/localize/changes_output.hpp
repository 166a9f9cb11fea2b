// What `gdtslam localize --track --changes` tells of changes in the map: a picture, a table beside it, a line for
// people and JSON for programs. Everything depends on the input alone. Thread-safe; O(cells + pixels).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/runs/localizer/drive_changes.hpp"
#include "engine/runs/localizer/scans.hpp"

namespace gdtslam {

/// "office.csv" for "office.png".
std::string changes_table_file(const std::string& picture);

/// Writes the picture, and the table beside it. Throws FileError, UnavailableError.
void write_changes(const std::string& picture, const LocalizeJob& job, const DriveChanges& seen,
                   const MapChanges& changes);

std::string as_text(const DriveChanges& seen, const MapChanges& changes);
nlohmann::ordered_json as_json(const DriveChanges& seen, const MapChanges& changes);

}  // namespace gdtslam
