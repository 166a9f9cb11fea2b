#include "ring_run.hpp"

#include <unistd.h>

#include <fstream>
#include <iterator>
#include <memory>

#include "engine/io/logs/carmen_writer.hpp"
#include "gdtslam/core/random.hpp"
#include "unit/back_end/loop_drive.hpp"

namespace gdtslam::test {

RunsFolder::RunsFolder(const std::string& name)
    : folder_(std::filesystem::temp_directory_path() / ("gdtslam-" + name + "-" + std::to_string(::getpid()))) {
  std::filesystem::remove_all(folder_);
  std::filesystem::create_directories(folder_);
}

RunsFolder::~RunsFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void write_ring_log(const std::string& file, const std::vector<Pose2>& truth, std::uint64_t seed) {
  write_drive_log(file, {rooms_around_a_block(), 1000.0}, truth, seed);
}

void write_drive_log(const std::string& file, const DrivenPlace& place, const std::vector<Pose2>& truth,
                     std::uint64_t seed) {
  Random random(seed);
  std::ofstream log(file);
  CarmenWriter writer(4);
  Pose2 T_odom_base;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    if (k > 0) {
      const double x_m = random.normal(0.0, 0.004);
      const double y_m = random.normal(0.0, 0.002);
      const double turn_rad = random.normal(0.0, 0.002);
      T_odom_base = T_odom_base * (between(truth[k - 1], truth[k]) * exp_se2({x_m, y_m, turn_rad}));
    }
    ScanRecord record;
    record.scan = scan_of(place.walls, truth[k], place.begins_at_s + 0.5 * static_cast<double>(k), 180);
    record.T_odom_base = T_odom_base;
    log << writer.scan(record);
  }
}

std::vector<Pose2> ring_drive() {
  std::vector<Pose2> truth = poses_around_ring(2);
  truth.resize(truth.size() / 2 + 40);
  return truth;
}

MapRequest ring_request(const std::string& log, const std::string& folder) {
  MapRequest request;
  request.logs = {log};
  request.folder = folder;
  request.with_pictures = false;
  return request;
}

const RingRun& ring_run() {
  static const RunsFolder folder("ring-run");
  static const RingRun run = [] {
    RingRun made{.log = folder.path("ring.log"), .folder = folder.path("run"), .truth = {}, .result = {}};
    write_ring_log(made.log, ring_drive(), 5);
    for (const Pose2& pose : ring_drive()) made.truth.push_back(in_ring_map(pose));
    const std::unique_ptr<Backend> cpu = make_cpu_backend({});
    MapRequest request = ring_request(made.log, made.folder);
    request.with_pictures = true;
    made.result = map_logs(request, *cpu);
    return made;
  }();
  return run;
}

std::string text_of_file(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace gdtslam::test
