#include "sweep_assembler_strips.hpp"

#include <algorithm>
#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

/// Moves `segment` on until it is the one between two knots that holds the time; the last one holds all that is later.
template <class Knot>
void go_to(double time_s, std::span<const Knot> knots, std::size_t& segment) {
  while (segment + 2 < knots.size() && time_s >= knots[segment + 1].offset_s) ++segment;
}

/// Where a time lies between a knot and the next, 0 to 1.
template <class Knot>
double share_of(double time_s, std::span<const Knot> knots, std::size_t segment) {
  if (segment + 1 >= knots.size()) return 0.0;
  const double length = knots[segment + 1].offset_s - knots[segment].offset_s;
  return length > 0.0 ? std::clamp((time_s - knots[segment].offset_s) / length, 0.0, 1.0) : 1.0;
}

class StripCutter {
 public:
  explicit StripCutter(const ScanMotion& motion) : motion_(motion) {}

  /// The strip that begins with a beam; beams are asked for in order.
  ScanStrip strip_from(std::size_t first) {
    const double begin_s = motion_.timing.of_beam_s(first);
    go_to(begin_s, motion_.phases, phase_segment_);
    go_to(begin_s, motion_.poses, pose_segment_);
    const std::size_t end = bend_end(first, segment_end(first));
    ScanStrip strip;
    strip.first = first;
    strip.count = static_cast<std::uint32_t>(end - first);
    const double last_s = motion_.timing.of_beam_s(end - 1);
    set_phases(strip, begin_s, last_s);
    set_poses(strip, begin_s, last_s);
    return strip;
  }

 private:
  template <class Knot>
  [[nodiscard]] static bool is_beyond(double time_s, std::span<const Knot> knots, std::size_t segment) {
    return segment + 2 < knots.size() && time_s >= knots[segment + 1].offset_s;
  }

  /// The first beam that does not lie between the same knots any more.
  [[nodiscard]] std::size_t segment_end(std::size_t first) const {
    const std::size_t most = std::min<std::size_t>(motion_.beams, first + kMostBeamsOfStrip);
    std::size_t end = first + 1;
    for (; end < most; ++end) {
      const double time_s = motion_.timing.of_beam_s(end);
      if (is_beyond(time_s, motion_.phases, phase_segment_) || is_beyond(time_s, motion_.poses, pose_segment_)) break;
    }
    return end;
  }

  /// An end so near that the sensor's place goes nearly straight.
  [[nodiscard]] std::size_t bend_end(std::size_t first, std::size_t end) const {
    const std::size_t count = end - first;
    const double turn_rad = std::fabs(wrap_angle(base_at(motion_.timing.of_beam_s(end - 1)).theta_rad -
                                                 base_at(motion_.timing.of_beam_s(first)).theta_rad));
    const double arm_m = std::sqrt(motion_.T_base_level.x_m * motion_.T_base_level.x_m +
                                   motion_.T_base_level.y_m * motion_.T_base_level.y_m);
    const double pieces = std::ceil(turn_rad * std::sqrt(arm_m / (8.0 * kMostSagitta_m)));
    if (!(pieces > 1.0)) return end;
    if (pieces >= static_cast<double>(count)) return first + 1;
    const auto parts = static_cast<std::size_t>(pieces);
    return first + (count + parts - 1) / parts;
  }

  [[nodiscard]] Pose2 base_at(double time_s) const {
    const Pose2& from = motion_.poses[pose_segment_].T_fix_base;
    const double share = share_of(time_s, motion_.poses, pose_segment_);
    if (share == 0.0) return from;
    const Pose2& to = motion_.poses[pose_segment_ + 1].T_fix_base;
    return {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m),
            from.theta_rad + share * wrap_angle(to.theta_rad - from.theta_rad)};
  }

  /// In 2^-32 turns after the segment's first knot.
  [[nodiscard]] double turned(double time_s) const {
    if (phase_segment_ + 1 >= motion_.phases.size()) return 0.0;
    const Phase difference = motion_.phases[phase_segment_ + 1].phase - motion_.phases[phase_segment_].phase;
    const double short_way = static_cast<double>(static_cast<std::int32_t>(difference));
    return short_way * share_of(time_s, motion_.phases, phase_segment_);
  }

  void set_phases(ScanStrip& strip, double begin_s, double last_s) const {
    const auto whole = [](double value) {
      return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(value + 0.5)));
    };
    const double first = turned(begin_s);
    strip.phase = motion_.phases[phase_segment_].phase + whole(first);
    if (strip.count > 1) strip.phase_step = whole((turned(last_s) - first) / (strip.count - 1.0));
  }

  void set_poses(ScanStrip& strip, double begin_s, double last_s) const {
    strip.T_fix_level = base_at(begin_s) * motion_.T_base_level;
    if (strip.count < 2) return;
    const Pose2 last = base_at(last_s) * motion_.T_base_level;
    const double steps = strip.count - 1.0;
    strip.step = {(last.x_m - strip.T_fix_level.x_m) / steps, (last.y_m - strip.T_fix_level.y_m) / steps,
                  wrap_angle(last.theta_rad - strip.T_fix_level.theta_rad) / steps};
  }

  const ScanMotion& motion_;
  std::size_t phase_segment_ = 0;
  std::size_t pose_segment_ = 0;
};

}  // namespace

std::vector<ScanStrip> strips_of(const ScanMotion& motion) {
  std::vector<ScanStrip> strips;
  StripCutter cutter(motion);
  for (std::size_t first = 0; first < motion.beams;) {
    strips.push_back(cutter.strip_from(first));
    first += strips.back().count;
  }
  return strips;
}

}  // namespace gdtslam
