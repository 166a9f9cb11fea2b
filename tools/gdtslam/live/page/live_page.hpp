// Shows a running drive in a browser: map, path, scan, evidence for the pose. It is served to this host alone unless an
// address is given. A visitor cannot change anything. One thread hands over scans, at the cost of a copy; another one
// maps. The page's own thread does the rest.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// A scan as the page shows it.
struct ShownScan {
  std::uint64_t scan = 0;
  LaserScan laser;
  ScanConfig valid;                 ///< which of its ranges are valid
  std::optional<Pose2> T_map_base;  ///< in the frame of the map that is shown
  bool is_in_doubt = false;
  /// Names and values as the page prints them; the page's thread calls this.
  std::function<std::vector<std::pair<std::string, std::string>>()> figures;
};

class LivePage {
 public:
  LivePage() = default;
  LivePage(const LivePage&) = delete;
  LivePage& operator=(const LivePage&) = delete;
  virtual ~LivePage() = default;

  [[nodiscard]] virtual std::string url() const = 0;
  /// Whether a browser is connected; thread-safe.
  [[nodiscard]] virtual bool is_watched() const = 0;
  /// Takes every scan; a visitor gets the newest one, which is turned into text only then.
  virtual void show(ShownScan scan) = 0;
  /// The path in the map's frame.
  virtual void show(const OccupancyMap& map, const Trajectory& path) = 0;
};

/// `address` is a PORT of this host alone, or ADDRESS:PORT; port 0 picks a free one. Throws UsageError for any other
/// text, FileError if the page cannot be served there, UnavailableError if this build has no page.
std::unique_ptr<LivePage> open_page(const std::string& address, const std::string& title);

}  // namespace gdtslam
