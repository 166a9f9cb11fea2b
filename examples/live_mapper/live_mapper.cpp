// Maps live: CARMEN lines come in on standard input, and for each scan one line goes out as soon as its pose is known:
//
//   stamp x y theta accepted|predicted doubt
//
// seconds, metres and radians, the robot in the map, whose origin is its pose at the first scan. With a robot that logs
// to a pipe, `robot_logger | live_mapper`; with a recorded log, `zcat drive.log.gz | live_mapper`. Where each scan
// carries its odometry, as FLASER lines do, the poses are the same, bit for bit, as those of `gdtslam map`. Where the
// odometry comes in records of its own, `gdtslam map` interpolates it between the records before and after the scan;
// here the one after is not known yet and the last one serves.
//
// With --loops, loops are looked for beside the mapping. Poses are then those of the front end, which never leap; where
// loops that were found take effect, a line of another form follows that of the scan:
//
//   correction x y theta
//
// metres and radians: correction * pose, as a product of rigid motions, is the pose in the frame in which places that
// were seen again lie where they were. It holds until the next such line; at first it is none (0 0 0).
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace {

void print_pose(const gdtslam::MatchResult& result) {
  const gdtslam::Pose2& T = result.T_map_base;
  const std::string doubt(gdtslam::to_string(result.doubt));
  std::printf("%.9f %.9f %.9f %.9f %s %s\n", result.stamp_s, T.x_m, T.y_m, T.theta_rad,
              result.accepted ? "accepted" : "predicted", doubt.c_str());
  std::fflush(stdout);  // whoever steers by the pose needs it now
}

void print_correction(const gdtslam::Pose2& T_closed_front) {
  std::printf("correction %.9f %.9f %.9f\n", T_closed_front.x_m, T_closed_front.y_m, T_closed_front.theta_rad);
  std::fflush(stdout);
}

// Calls map(scan, T_odom_base) for each scan.
template <class Map>
void map_standard_input(const Map& map) {
  const std::unique_ptr<gdtslam::LogReader> log = gdtslam::open_log("-", {});
  std::optional<gdtslam::Pose2> T_odom_base;
  while (const std::optional<gdtslam::LogRecord> record = log->next()) {
    if (const auto* odometry = std::get_if<gdtslam::Odometry>(&*record)) T_odom_base = odometry->T_odom_base;
    if (const auto* scan = std::get_if<gdtslam::ScanRecord>(&*record)) {
      // A scan that carries odometry knows best; else the last known pose of the wheels serves.
      map(scan->scan, scan->T_odom_base ? scan->T_odom_base : T_odom_base);
    }
  }
}

void map_without_loops(gdtslam::Backend& backend) {
  gdtslam::Mapper mapper({}, backend);
  map_standard_input([&](const gdtslam::LaserScan& scan, const std::optional<gdtslam::Pose2>& T_odom_base) {
    print_pose(mapper.process(scan, T_odom_base));
  });
}

void map_with_loops(gdtslam::Backend& backend) {
  gdtslam::Mapper mapper({}, backend, {.with_loops = true});
  const gdtslam::LoopClosing& loops = *mapper.loops();
  gdtslam::Pose2 T_closed_front;
  map_standard_input([&](const gdtslam::LaserScan& scan, const std::optional<gdtslam::Pose2>& T_odom_base) {
    print_pose(mapper.process(scan, T_odom_base));
    if (loops.correction() == T_closed_front) return;
    T_closed_front = loops.correction();
    print_correction(T_closed_front);
  });
}

}  // namespace

int main(int argc, char** argv) {
  const bool with_loops = argc == 2 && std::string_view(argv[1]) == "--loops";
  if (argc > 1 && !with_loops) {
    const bool wants_help = std::string_view(argv[1]) == "--help" || std::string_view(argv[1]) == "-h";
    std::fputs(
        "Usage: live_mapper [--loops] < LOG\nCARMEN lines in, for each scan a line out: stamp x y theta "
        "accepted|predicted doubt\nWith --loops also, where loops take effect: correction x y theta\n",
        wants_help ? stdout : stderr);
    return wants_help ? 0 : static_cast<int>(gdtslam::ExitCode::kUsage);
  }
  try {
    const std::unique_ptr<gdtslam::Backend> backend = gdtslam::make_cpu_backend({});
    with_loops ? map_with_loops(*backend) : map_without_loops(*backend);
    return 0;
  } catch (const gdtslam::Error& error) {
    std::fprintf(stderr, "live_mapper: error: %s\n", error.what());
    return static_cast<int>(error.code());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "live_mapper: error: %s\n", error.what());
    return 1;
  }
}
