// Chunks of a bag, unpacked as they are read. One source belongs to one thread.
#pragma once

#include <memory>
#include <string_view>

#include "engine/io/byte_source.hpp"

namespace gdtslam {

/// `compression` as a chunk's header has it: none, bz2 or lz4 (frames). Throws BagFault for another one; reading throws
/// BagFault where the data are damaged or stop early.
std::unique_ptr<ByteSource> unpacked_chunk(std::unique_ptr<ByteSource> packed, std::string_view compression);

}  // namespace gdtslam
