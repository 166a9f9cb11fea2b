// Chunks of MCAP files, packed whole. Thread-safe; throws Error where a library runs out of memory.
#pragma once

#include <string>
#include <string_view>

#include "log_writer.hpp"

namespace gdtslam {

/// "none", "lz4", "zstd"; an MCAP file has an empty text for none.
std::string_view packing_name(ChunkPacking packing);
/// lz4 is a frame of independent blocks with a checksum.
std::string packed_chunk(const std::string& bytes, ChunkPacking packing);

}  // namespace gdtslam
