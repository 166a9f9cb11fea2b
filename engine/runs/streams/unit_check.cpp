#include "unit_check.hpp"

#include <fmt/format.h>

#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr float kFar_m = 100.0F;      // half of a scan is never so far from a 2D laser
constexpr double kFast_rad_s = 10.0;  // 1.6 turns a second
constexpr double kFastTurn_rad = 0.3;
constexpr std::uint64_t kLeastFastSteps = 10;

}  // namespace

void UnitCheck::add_ranges(const LaserScan& scan) {
  for (const float range_m : scan.ranges_m) {
    if (!std::isfinite(range_m) || !(range_m > 0.0F)) continue;
    ++ranges_;
    if (range_m < kFar_m || range_m == last_far_m_) continue;
    ++far_;
    last_far_m_ = range_m;
  }
}

void UnitCheck::add_heading(double stamp_s, double heading_rad) {
  const std::optional<Heading> before = last_heading_;
  last_heading_ = {stamp_s, heading_rad};
  if (!before || !(stamp_s > before->stamp_s)) return;
  const double turn_rad = std::fabs(heading_rad - before->angle_rad);
  const double wrapped_rad = std::fabs(wrap_angle(turn_rad));
  // A heading in radians leaps by a whole turn where it is wrapped.
  const bool is_fast = wrapped_rad > kFastTurn_rad && turn_rad > kFast_rad_s * (stamp_s - before->stamp_s);
  turned_rad_ += is_fast ? turn_rad : wrapped_rad;
  if (!is_fast) return;
  turned_fast_rad_ += turn_rad;
  ++fast_steps_;
}

std::vector<std::string> UnitCheck::questions() const {
  std::vector<std::string> list;
  if (are_ranges_doubtful()) {
    list.push_back(
        fmt::format("ranges are taken as metres, and {:.1f} % of them are {:g} m and more: are they millimetres or "
                    "centimetres? Then convert them to metres",
                    100.0 * static_cast<double>(far_) / static_cast<double>(ranges_), kFar_m));
  }
  if (fast_steps_ >= kLeastFastSteps && 2.0 * turned_fast_rad_ > turned_rad_) {
    list.push_back(
        fmt::format("headings of the odometry are taken as radians, and {} times it turns faster than {:g} rad/s: are "
                    "they degrees? Then convert them to radians",
                    fast_steps_, kFast_rad_s));
  }
  return list;
}

}  // namespace gdtslam
