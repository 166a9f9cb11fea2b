#include "run_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "engine/io/atomic_file.hpp"
#include "engine/io/logs/steady_mount.hpp"
#include "engine/io/writers/mcap_writer.hpp"
#include "engine/runs/streams/scan_stream.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kMapFrame = "map";
constexpr std::string_view kRobotFrame = "base_link";

std::int8_t ros_occupancy(CellState state) {
  if (state == CellState::kUnknown) return -1;
  return state == CellState::kOccupied ? 100 : 0;
}

std::string grid_message(const OccupancyMap& map, double stamp_s) {
  std::vector<std::int8_t> cells(map.cells.size());
  for (std::size_t cell = 0; cell < cells.size(); ++cell) cells[cell] = ros_occupancy(map.cells[cell]);
  const GridGeometry& geometry = map.geometry;
  return ros_occupancy_grid({stamp_s, kMapFrame}, {.resolution_m = geometry.resolution_m,
                                                   .width = static_cast<std::uint32_t>(geometry.width),
                                                   .height = static_cast<std::uint32_t>(geometry.height),
                                                   .T_map_origin = {geometry.origin_x_m, geometry.origin_y_m, 0.0},
                                                   .cells = cells});
}

/// Makes the messages, scan by scan.
class RunMessages {
 public:
  explicit RunMessages(AtomicFile& file) : writer_(file, ChunkPacking::kZstd) {
    map_ = writer_.add_channel("/map", RosType::kOccupancyGrid, true);
    mounts_ = writer_.add_channel("/tf_static", RosType::kTransforms, true);
    transforms_ = writer_.add_channel("/tf", RosType::kTransforms, false);
    poses_ = writer_.add_channel("/pose", RosType::kPoseStamped, false);
    scans_ = writer_.add_channel("/scan", RosType::kLaserScan, false);
  }
  void add_map(const OccupancyMap& map, double stamp_s) {
    writer_.add(map_, received_ns(stamp_s), grid_message(map, stamp_s));
  }
  void add(const ScanRecord& record, const Pose2& T_map_base) {
    const LaserScan& scan = record.scan;
    const std::int64_t now_ns = received_ns(scan.stamp_s);
    const RosStamp in_map{scan.stamp_s, kMapFrame};
    const std::string frame = record.laser == 0 ? "laser" : fmt::format("laser_{}", record.laser + 1);
    if (const auto told = told_.find(record.laser);
        told == told_.end() || !is_same_mount(told->second, scan.T_base_laser)) {
      told_[record.laser] = scan.T_base_laser;
      add_transform(mounts_, now_ns, {{scan.stamp_s, kRobotFrame}, frame, scan.T_base_laser});
    }
    add_transform(transforms_, now_ns, {in_map, kRobotFrame, T_map_base});
    writer_.add(poses_, now_ns, ros_pose(in_map, T_map_base));
    writer_.add(scans_, now_ns, ros_laser_scan(scan, frame, 0.0));
  }
  void finish() { writer_.finish(); }

 private:
  void add_transform(std::uint32_t channel, std::int64_t now_ns, const RosTransform& transform) {
    writer_.add(channel, now_ns, ros_transforms({&transform, 1}));
  }
  std::int64_t received_ns(double stamp_s) {
    newest_ns_ = std::max(newest_ns_, ros_time_ns(stamp_s));
    return newest_ns_;
  }

  McapWriter writer_;
  std::uint32_t map_ = 0;
  std::uint32_t mounts_ = 0;
  std::uint32_t transforms_ = 0;
  std::uint32_t poses_ = 0;
  std::uint32_t scans_ = 0;
  std::map<std::size_t, Pose2> told_;  ///< mounts, by laser
  std::int64_t newest_ns_ = 0;
};

}  // namespace

std::size_t write_run_recording(const std::string& file, const std::vector<std::string>& logs,
                                const ReadOptions& options, const ScanRange& range, const MapOutcome& outcome) {
  AtomicFile target(file);
  RunMessages messages(target);
  ScanStream scans(logs, options, range);
  std::size_t left_out = 0;
  bool has_map = false;
  for (const StampedPose& pose : outcome.trajectory) {
    const std::optional<ScanRecord> record = scans.next();
    if (!record) break;
    const double first_beam_s = ros_scan_stamp_s(record->scan);
    const double earliest_s = std::min(record->scan.stamp_s, first_beam_s);
    if (!(earliest_s >= 0.0) || !(std::max(record->scan.stamp_s, first_beam_s) < kRosStampLimit_s)) {
      ++left_out;
      continue;
    }
    if (!has_map) messages.add_map(outcome.occupancy, record->scan.stamp_s);
    has_map = true;
    messages.add(*record, pose.T_map_base);
  }
  messages.finish();
  target.commit();
  return left_out;
}

}  // namespace gdtslam
