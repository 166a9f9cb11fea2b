// Scans as the laser gave them that wait until it is known where they belong. 4 bytes a range and 120 a scan.
#pragma once

#include "engine/core/memory/byte_shelf.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

void put_on(ByteShelf& shelf, const LaserScan& scan);
void take_from(std::span<const std::byte> record, LaserScan& scan);

using LaserShelf = Shelf<LaserScan>;

}  // namespace gdtslam
