// Scans that wait for the end of a drive. 20 bytes a point on a surface, 8 another, 16 a scan.
#pragma once

#include "engine/core/memory/byte_shelf.hpp"
#include "engine/mapping/surface/surface_points.hpp"

namespace gdtslam {

void put_on(ByteShelf& shelf, const KeptScan& scan);
void take_from(std::span<const std::byte> record, KeptScan& scan);

using ScanShelf = Shelf<KeptScan>;

}  // namespace gdtslam
