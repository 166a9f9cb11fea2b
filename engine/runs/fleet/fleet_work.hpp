// Maps one log of a fleet to its run folder and its record in the atlas. Cost: mapping the log; a log that is already
// done is only hashed.
#pragma once

#include <functional>
#include <string>

#include "atlas.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

struct FleetWork {
  std::string atlas;
  std::string options;   ///< the text of options.txt
  MapRequest request{};  ///< the part common to all logs, without logs and folder
  std::function<MapResult(const MapRequest&)> map{};
  std::string host{};
};

struct MappedFleetLog {
  FleetRecord record;
  bool was_done = false;  ///< by an earlier command, with the same bytes and options
};

/// Maps the log unless its record has the same bytes and options and its run folder exists. A fault of the log or the
/// machine goes to the record. Throws UsageError if another process works on the log, Error(kInterrupted), and
/// FileError if the atlas is gone or the record cannot be written.
MappedFleetLog map_fleet_log(const FleetWork& work, const std::string& log);

inline constexpr const char* kThumbnailName = "thumbnail.png";

/// Writes the thumbnail to the record's folder: map and path, without text, 320 x 180 at twice as many pixels. Does
/// nothing if there is no map or nothing can draw. Throws FileError.
void write_thumbnail(const std::string& folder, const MapOutcome& outcome);

}  // namespace gdtslam
