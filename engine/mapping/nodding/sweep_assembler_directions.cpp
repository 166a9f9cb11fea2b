#include "sweep_assembler_directions.hpp"

#include <algorithm>

#include "engine/mapping/map/scan_beams.hpp"

namespace gdtslam {

std::optional<std::uint32_t> BeamDirections::row_of(const LaserScan& scan) {
  const std::size_t beams = scan.ranges_m.size();
  const auto is_same = [&](const Layout& layout) {
    return layout.first_bearing_rad == scan.first_bearing_rad && layout.bearing_step_rad == scan.bearing_step_rad &&
           layout.beams >= beams;
  };
  const auto found = std::find_if(layouts_.begin(), layouts_.end(), is_same);
  if (found != layouts_.end()) return found->row;
  if (!rows_.empty() && rows_.size() + beams > kMostRows) return std::nullopt;
  const auto row = static_cast<std::uint32_t>(rows_.size());
  layouts_.push_back({scan.first_bearing_rad, scan.bearing_step_rad, beams, row});
  for (std::size_t beam = 0; beam < beams; ++beam) {
    append(beam_bearing_rad(scan, beam));
  }
  return row;
}

void BeamDirections::clear() {
  layouts_.clear();
  rows_.clear();
}

// Rz(yaw) Rx(roll) (cos bearing, sin bearing, 0).
void BeamDirections::append(double bearing_rad) {
  const auto bearing = sin_cos(bearing_rad);
  const auto roll = sin_cos(mount_.sensor_roll_rad);
  const auto yaw = sin_cos(mount_.sensor_yaw_rad);
  const double left = bearing.sin * roll.cos;
  rows_.push_back({static_cast<float>(yaw.cos * bearing.cos - yaw.sin * left),
                   static_cast<float>(yaw.sin * bearing.cos + yaw.cos * left),
                   static_cast<float>(bearing.sin * roll.sin)});
}

}  // namespace gdtslam
