#include "laser_shelf.hpp"

#include <array>
#include <utility>

namespace gdtslam {
namespace {

/// A scan without its ranges.
struct ScanHead {
  double stamp_s;
  double first_bearing_rad;
  double bearing_step_rad;
  double max_range_m;
  double first_beam_after_s;
  double beam_period_s;
  std::array<double, 3> speed;
  std::array<double, 3> T_base_laser;
  std::uint32_t has_speed;
  std::uint32_t ranges;
};

}  // namespace

void put_on(ByteShelf& shelf, const LaserScan& scan) {
  const Eigen::Vector3d speed = scan.speed.value_or(Eigen::Vector3d::Zero());
  const Pose2& mount = scan.T_base_laser;
  const ScanHead head{.stamp_s = scan.stamp_s,
                      .first_bearing_rad = scan.first_bearing_rad,
                      .bearing_step_rad = scan.bearing_step_rad,
                      .max_range_m = scan.max_range_m,
                      .first_beam_after_s = scan.first_beam_after_s,
                      .beam_period_s = scan.beam_period_s,
                      .speed = {speed.x(), speed.y(), speed.z()},
                      .T_base_laser = {mount.x_m, mount.y_m, mount.theta_rad},
                      .has_speed = scan.speed ? 1U : 0U,
                      .ranges = static_cast<std::uint32_t>(scan.ranges_m.size())};
  shelf.put({value_bytes(head), std::as_bytes(std::span(scan.ranges_m))});
}

void take_from(std::span<const std::byte> record, LaserScan& scan) {
  ScanHead head;
  take_values(record, std::span(&head, 1));
  scan = {.stamp_s = head.stamp_s,
          .first_bearing_rad = head.first_bearing_rad,
          .bearing_step_rad = head.bearing_step_rad,
          .max_range_m = head.max_range_m,
          .first_beam_after_s = head.first_beam_after_s,
          .beam_period_s = head.beam_period_s,
          .speed = {},
          .ranges_m = std::vector<float>(head.ranges),
          .T_base_laser = {head.T_base_laser[0], head.T_base_laser[1], head.T_base_laser[2]}};
  if (head.has_speed != 0U) scan.speed.emplace(head.speed[0], head.speed[1], head.speed[2]);
  take_values(record, std::span(scan.ranges_m));
}

std::vector<LaserScan> read_scans(const LaserShelf& shelf, const std::vector<bool>& is_there,
                                  std::span<const std::size_t> wanted) {
  std::vector<LaserScan> chosen;
  chosen.reserve(wanted.size());
  LaserShelf::Reader scans(shelf);
  auto next = wanted.begin();
  for (std::size_t i = 0; i < is_there.size() && next != wanted.end(); ++i) {
    if (!is_there[i]) continue;
    LaserScan scan = scans.next();
    if (*next != i) continue;
    chosen.push_back(std::move(scan));
    ++next;
  }
  return chosen;
}

}  // namespace gdtslam
