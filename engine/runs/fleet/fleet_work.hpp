// A log of a fleet, from its file to its run folder and its record in the atlas. Cost: that of mapping the log; one
// that is done already is only hashed.
#pragma once

#include <functional>
#include <string>

#include "atlas.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

struct FleetWork {
  std::string atlas;
  std::string options;   ///< the text of options.txt
  MapRequest request{};  ///< the part that all logs have in common: neither logs nor folder
  std::function<MapResult(const MapRequest&)> map{};
  std::string host{};
};

struct MappedFleetLog {
  FleetRecord record;
  bool was_done = false;  ///< by an earlier command, with the same bytes and options
};

/// Maps the log unless its record names the same bytes and options and its run folder is there. What is wrong with the
/// log or the machine becomes the record. Throws UsageError if another process works on the log, Error(kInterrupted),
/// and FileError if the atlas is gone or the record cannot be written.
MappedFleetLog map_fleet_log(const FleetWork& work, const std::string& log);

inline constexpr const char* kThumbnailName = "thumbnail.png";

/// Writes it into the folder of the record: map and path, without words, 320 x 180 at twice as many pixels. Does
/// nothing if there is no map or nothing can draw. Throws FileError.
void write_thumbnail(const std::string& folder, const MapOutcome& outcome);

}  // namespace gdtslam
