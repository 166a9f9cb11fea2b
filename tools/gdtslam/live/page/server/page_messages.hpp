// Answers of the page's server: the page, the newest scan and the map, in the format of
// engine/drawing/page/program/live.js.
#pragma once

#include <cstdint>
#include <string>

#include "tools/gdtslam/live/page/live_page.hpp"

namespace gdtslam {

/// Head of each answer: the drive, because another one may follow at the same address; the page's origin in the map;
/// the version of the map.
struct PageDrive {
  std::string name;
  Point2 origin_m{0.0, 0.0};
  std::uint64_t map = 0;
};

std::string live_page_text(const PageDrive& drive, const std::string& title);
/// JSON with places in the map's frame, in centimetres; only the drive if `scan` is null.
std::string scan_message(const PageDrive& drive, const ShownScan* scan);
/// JSON with path and map in the format of a run's page, compressed (RFC 1950).
std::string map_message(const PageDrive& drive, const OccupancyMap& map, const Trajectory& path);

}  // namespace gdtslam
