// Opens a log of whatever kind it is. Kinds are told apart by content, not by name. Memory and threads as in
// carmen.hpp.
#pragma once

#include <memory>
#include <string>

#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/read_options.hpp"

namespace gdtslam {

/// A CARMEN text log, plain or gzip; "-" is standard input. Throws InputError that names what is supported for a bag,
/// an MCAP file or a folder, FileError for what cannot be read.
std::unique_ptr<LogReader> open_log(const std::string& path, const ReadOptions& options);

}  // namespace gdtslam
