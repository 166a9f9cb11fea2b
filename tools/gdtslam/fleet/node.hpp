// The machine that computes units: what it is, and whether it computes what the plan's program does.
#pragma once

#include <string>

#include "engine/runs/fleet/plan.hpp"
#include "engine/runs/fleet/unit.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"

namespace gdtslam {

/// This program: its version and what it is known to make of the sample log (assets/expected). Throws FileError,
/// InputError.
FleetProgram this_program();

/// Name of this machine, in letters that a file's name may have; Slurm's name of it where it has one, for several of
/// its nodes may be one machine.
std::string host_name();

/// Processors that this process may use: SLURM_CPUS_PER_TASK where a scheduler says so, else those of its affinity.
unsigned usable_processors();

/// Maps the sample log in a process of its own, below `folder`, and writes nodes/HOST.json unless `atlas` is
/// empty. Throws Error(kOtherResults) where version or hashes are not those of the plan; what make_backend() throws.
UnitPlace checked_node(const StoredPlan& stored, const std::string& atlas, const DeviceOptions& device,
                       const std::string& folder);

/// One thread, so that as many processes as processors fill them.
DeviceOptions of_one_thread(DeviceOptions device);

}  // namespace gdtslam
