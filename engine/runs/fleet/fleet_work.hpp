// A log of a fleet, from its file to its run folder and its record in the atlas. Cost: that of mapping the log; one
// that is done already is only hashed.
#pragma once

#include <functional>
#include <string>

#include "fleet_record.hpp"
#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

struct FleetWork {
  std::string atlas;
  std::string options;   ///< the text of options.txt
  MapRequest request{};  ///< what all logs have in common: neither logs nor folder
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

}  // namespace gdtslam
