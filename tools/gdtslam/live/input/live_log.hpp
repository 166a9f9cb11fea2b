// The log of a drive that is going on: an input's lines as records, read ahead into a queue where one is asked for.
#pragma once

#include <cstddef>
#include <memory>

#include "gdtslam/runs/map_log.hpp"
#include "live_input.hpp"

namespace gdtslam {

/// Opens the log of that input, once. With `queue` scans a thread reads ahead, and where more are waiting the oldest of
/// them is dropped, not its odometry; what was dropped is among the log's warnings, as is what the input lost. With 0
/// nothing is read before it is asked for, and the sender waits.
LiveLog live_log_of(std::shared_ptr<LiveInput> input, std::size_t queue);

}  // namespace gdtslam
