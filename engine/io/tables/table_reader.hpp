// Readers of CSV files and of JSON lines (docs/formats.md gives every column, rule and limit), for logs of users' own
// loggers. Metres, radians, seconds. Memory is bounded by the longest line allowed (4 MiB), for any length of the log.
// One reader belongs to one thread.
//
// File order is kept. A malformed row throws InputError with file, line and column, or is counted with
// ReadOptions::lenient; a cut last line is dropped and counted.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "engine/io/byte_source.hpp"
#include "engine/io/log_contents.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

enum class TableKind : std::uint8_t { kCsv, kJsonLines };

/// A log from an unpacked source. Throws InputError if it is empty.
std::unique_ptr<DescribedLog> open_table(TableKind kind, std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                         const ReadOptions& options);

}  // namespace gdtslam
