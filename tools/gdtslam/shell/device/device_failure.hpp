// What a mapper does when its device fails, as --no-fallback, --threads and --isa say.
#pragma once

#include "device_option.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

/// Goes on with the CPU that the options describe and prints one warning; or, without fallback, fails.
MapperOptions on_failure_of(const DeviceOptions& options);

}  // namespace gdtslam
