// Whether a file is a recording, by its first bytes. Thread-safe; at most 64 KiB of what it unpacks to are read.
#pragma once

#include <string>

namespace gdtslam {

/// True for the containers that open_log() reads (bags, MCAP, SQLite, log copies), and for text in whose first lines a
/// CARMEN message, a header of CSV with stamps and ranges or an object of JSON lines stands; packed or not. False for
/// what is no such file or cannot be read.
bool is_recording(const std::string& file);

}  // namespace gdtslam
