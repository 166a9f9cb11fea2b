// Answers of the page's server: the page, the newest scan and the map, as engine/drawing/page/program/live.js reads
// them.
#pragma once

#include <cstdint>
#include <string>

#include "tools/gdtslam/live/page/live_page.hpp"

namespace gdtslam {

/// Head of each answer: the drive, as another one may follow at the same address; where the page's frame lies in the
/// map's; the version of the map.
struct PageDrive {
  std::string name;
  Point2 origin_m{0.0, 0.0};
  std::uint64_t map = 0;
};

std::string live_page_text(const PageDrive& drive, const std::string& title);
/// JSON, places in the map's frame, centimetres; without a scan (null) the drive alone.
std::string scan_message(const PageDrive& drive, const ShownScan* scan);
/// JSON with path and map as pages of runs have them, compressed (RFC 1950).
std::string map_message(const PageDrive& drive, const OccupancyMap& map, const Trajectory& path);

}  // namespace gdtslam
