// A drive through a room as a file of JSON lines, with a fault in its scans or its odometry, and its map.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/runs/map_log.hpp"
#include "support/room.hpp"

namespace gdtslam::test {

struct MappedLog {
  std::vector<LogFinding> findings;
  std::string trajectory_sha256;
  std::size_t doubtful = 0;
};

class DriveLog {
 public:
  DriveLog() : folder_(std::filesystem::temp_directory_path() / fmt::format("gdtslam_drive_log_{}", ::getpid())) {
    std::filesystem::create_directories(folder_);
  }
  DriveLog(const DriveLog&) = delete;
  DriveLog& operator=(const DriveLog&) = delete;
  ~DriveLog() { std::filesystem::remove_all(folder_); }

  /// Five scans a second; a laser of 360 degrees, `mount` on the robot. What the log says of both may be changed.
  [[nodiscard]] std::string write(const std::function<void(LaserScan&)>& change_scan,
                                  const std::function<Pose2(Pose2)>& change_odometry = {},
                                  const Pose2& mount = {}) const {
    const std::string path = (folder_ / "drive.jsonl").string();
    std::ofstream file(path);
    double stamp_s = 100.0;
    for (const Pose2& truth : drive_through_room()) {
      LaserScan scan = full_turn(truth * mount);
      change_scan(scan);
      const Pose2 odometry = change_odometry ? change_odometry(truth) : truth;
      file << fmt::format(
          R"({{"stamp":{},"odom":[{},{},{}],"mount":[{},{},{}],"angle_min":{},"angle_increment":{},"range_max":{},"ranges":[{}]}})",
          stamp_s, odometry.x_m, odometry.y_m, odometry.theta_rad, scan.T_base_laser.x_m, scan.T_base_laser.y_m,
          scan.T_base_laser.theta_rad, scan.first_bearing_rad, scan.bearing_step_rad, scan.max_range_m,
          fmt::join(scan.ranges_m, ","));
      file << "\n";
      stamp_s += 0.2;
    }
    return path;
  }

  [[nodiscard]] MappedLog map(const std::string& path, const std::function<void(MapRequest&)>& change = {}) const {
    MapRequest request{.logs = {path}, .folder = (folder_ / "run").string()};
    request.with_pictures = request.with_map = false;
    if (change) change(request);
    const std::unique_ptr<Backend> cpu = make_cpu_backend({});
    const MapResult result = map_logs(request, *cpu);
    const std::string key = "\"trajectory_sha256\": \"";
    const std::size_t at = result.report.find(key);
    return {result.outcome.findings, result.report.substr(at + key.size(), 64), result.outcome.doubtful.size()};
  }

 private:
  static LaserScan full_turn(const Pose2& T_map_laser) {
    static const std::vector<Segment> walls = furnished_room();
    const Pose2 back = T_map_laser * Pose2{0.0, 0.0, kPi};
    LaserScan scan = scan_of(walls, T_map_laser, 0.0, 90);
    const LaserScan rear = scan_of(walls, back, 0.0, 90);
    scan.ranges_m.insert(scan.ranges_m.end(), rear.ranges_m.begin(), rear.ranges_m.end());
    scan.max_range_m = 80.0;
    return scan;
  }

  std::filesystem::path folder_;
};

}  // namespace gdtslam::test
