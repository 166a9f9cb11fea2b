// A unit of a plan, from its log to its record. Runs in a process of its own. Cost: that of mapping the log.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "gdtslam/runs/map_log.hpp"
#include "plan.hpp"
#include "record.hpp"

namespace gdtslam {

/// Where a unit is computed.
struct UnitPlace {
  std::string host;
  std::string isa;
  std::string device;
};

/// The configuration of a plan, without what it says of recordings. Throws ConfigError.
Settings plan_settings(const FleetPlan& plan);

struct UnitWork {
  const StoredPlan& stored;
  std::size_t unit = 0;
  std::string atlas;
  Settings settings;    ///< of the plan, with what it says of recordings
  std::string folder;   ///< an empty one, where to work
  std::string staging;  ///< on the atlas' disk
  UnitPlace place;
  std::function<MapResult(const MapRequest&)> map;
  std::function<void(double share)> progress{};
  std::function<bool()> stop{};
};

/// Maps the log, moves the run folder into the atlas and writes the record. What bad data are to blame for (exit 2, 65,
/// 78) becomes a record that says so; what the machine is to blame for is thrown and leaves no record: LogUnavailable,
/// FileError, for a log that was changed meanwhile too, DeviceError, OutOfMemory, Error(kInterrupted).
UnitRecord do_unit(const UnitWork& work);

/// The same without an atlas: the record that the unit would have. For `fleet verify`.
UnitRecord compute_unit(const UnitWork& work);

}  // namespace gdtslam
