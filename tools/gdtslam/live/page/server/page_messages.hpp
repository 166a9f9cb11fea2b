// What the page's websocket carries: of a scan JSON, of the map a header in JSON, its length before it, and a picture.
// Each message names its drive, as another one may follow at the same address.
#pragma once

#include <string>
#include <string_view>

#include "tools/gdtslam/live/page/live_page.hpp"

namespace gdtslam {

/// Places in the map's frame, centimetres.
std::string scan_message(const ShownScan& scan, std::string_view drive);
/// Four bytes of the header's length (little-endian), the header, a PNG of at most some megapixels: black where
/// something stands, white where nothing does, grey elsewhere, the top row that of the largest y.
std::string map_message(const OccupancyMap& map, const Trajectory& path, std::string_view drive);
/// JSON without a scan, with the title of the drive's page: first of all, and where there is nothing new for long.
std::string sign_of_life_message(std::string_view drive, std::string_view title);
/// The page itself.
std::string live_page_text(const std::string& title);
/// What the page may do, as the value of its header Content-Security-Policy: its own style and script, its own
/// websocket.
std::string live_page_policy();

}  // namespace gdtslam
