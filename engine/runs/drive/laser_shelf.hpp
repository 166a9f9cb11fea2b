// Raw scans that wait until their poses are known. 4 bytes a range and 120 a scan.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/core/memory/byte_shelf.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

void put_on(ByteShelf& shelf, const LaserScan& scan);
void take_from(std::span<const std::byte> record, LaserScan& scan);

using LaserShelf = Shelf<LaserScan>;

/// Reads the wanted scans from a shelf that has the scans marked in `is_there`: numbers among all,
/// ascending. Throws FileError.
std::vector<LaserScan> read_scans(const LaserShelf& shelf, const std::vector<bool>& is_there,
                                  std::span<const std::size_t> wanted);

}  // namespace gdtslam
