#include "sweep_batch.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "engine/mapping/map/scan_beams.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

template <class T>
std::span<const std::byte> byte_view(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

SweepPoints::Params params_for(const NoddingScanner& scanner, const AssemblyLimits& limits) {
  SweepPoints::Params params;
  params.table_bits = scanner.table.bits();
  params.lever_x_m = static_cast<float>(scanner.mount.lever_forward_m);
  params.lever_z_m = static_cast<float>(scanner.mount.lever_up_m);
  params.height_m = static_cast<float>(scanner.mount.height_m);
  params.form = limits.form;
  return params;
}

/// Advances `segment` to the one between two knots that contains the time; the last one contains all later times.
template <class Knot>
void go_to(double time_s, std::span<const Knot> knots, std::size_t& segment) {
  while (segment + 2 < knots.size() && time_s >= knots[segment + 1].offset_s) ++segment;
}

/// Position of a time between a knot and the next, 0 to 1.
template <class Knot>
double segment_share(double time_s, std::span<const Knot> knots, std::size_t segment) {
  if (segment + 1 >= knots.size()) return 0.0;
  const double length = knots[segment + 1].offset_s - knots[segment].offset_s;
  return length > 0.0 ? std::clamp((time_s - knots[segment].offset_s) / length, 0.0, 1.0) : 1.0;
}

class StripCutter {
 public:
  explicit StripCutter(const ScanMotion& motion) : motion_(motion) {}

  /// The strip that begins with a beam; beams are requested in order.
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

  /// The first beam that is not between the same knots any more.
  [[nodiscard]] std::size_t segment_end(std::size_t first) const {
    const std::size_t most = std::min<std::size_t>(motion_.beams, first + kMostBeamsOfStrip);
    std::size_t end = first + 1;
    for (; end < most; ++end) {
      const double time_s = motion_.timing.of_beam_s(end);
      if (is_beyond(time_s, motion_.phases, phase_segment_) || is_beyond(time_s, motion_.poses, pose_segment_)) break;
    }
    return end;
  }

  /// An end close enough that the sensor moves nearly straight.
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
    const double share = segment_share(time_s, motion_.poses, pose_segment_);
    if (share == 0.0) return from;
    const Pose2& to = motion_.poses[pose_segment_ + 1].T_fix_base;
    return {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m),
            from.theta_rad + share * wrap_angle(to.theta_rad - from.theta_rad)};
  }

  /// Turn in 2^-32 turns after the segment's first knot.
  [[nodiscard]] double turned(double time_s) const {
    if (phase_segment_ + 1 >= motion_.phases.size()) return 0.0;
    const Phase difference = motion_.phases[phase_segment_ + 1].phase - motion_.phases[phase_segment_].phase;
    const double short_way = static_cast<double>(static_cast<std::int32_t>(difference));
    return short_way * segment_share(time_s, motion_.phases, phase_segment_);
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

void append_points(const SweepBatch& batch, const std::vector<SweptBeam>& swept, std::vector<CloudPoint>& points) {
  for (std::size_t i = 0; i < batch.beams.size(); ++i) {
    if (!(batch.beams[i].range_m > 0.0F)) continue;
    const std::uint32_t strip = batch.beams[i].strip;
    const StripOrigin& origin = batch.origins[strip];
    const std::size_t beam = origin.first_beam + (i - batch.strips[strip].first_beam);
    CloudPoint point;
    point.x_m = static_cast<float>(origin.anchor_x_m + static_cast<double>(swept[i][0]));
    point.y_m = static_cast<float>(origin.anchor_y_m + static_cast<double>(swept[i][1]));
    point.z_m = swept[i][2];
    point.elevation_rad = swept[i][3];
    point.stamp_s = origin.scan_stamp_s + origin.timing.of_beam_s(beam);
    point.scan = origin.scan;
    points.push_back(point);
  }
}

SweepDevice::SweepDevice(Backend& backend, const NoddingScanner& scanner, const AssemblyLimits& limits,
                         std::size_t most_beams)
    : backend_(backend),
      params_(params_for(scanner, limits)),
      elevations_(scanner.table.values_rad().begin(), scanner.table.values_rad().end()),
      beams_(backend.allocate(most_beams * sizeof(BeamRange))),
      points_(backend.allocate(most_beams * sizeof(SweptBeam))) {}

void SweepDevice::upload_tables(const std::shared_ptr<const BeamDirections>& directions) {
  const auto& rows = directions->rows();
  if (uploaded_ == directions && uploaded_rows_ == rows.size()) return;
  const auto elevations = byte_view(elevations_);
  const auto directions_data = byte_view(rows);
  const std::size_t bytes = elevations.size() + directions_data.size();
  if (tables_.bytes() < bytes) tables_ = backend_.allocate(std::bit_ceil(bytes));
  backend_.upload(tables_, elevations);
  backend_.upload(tables_, directions_data, elevations.size());
  uploaded_ = directions;
  uploaded_rows_ = rows.size();
}

PendingDownload SweepDevice::start(const SweepBatch& batch) {
  upload_tables(batch.directions);
  const auto strips = byte_view(batch.strips);
  if (strips_.bytes() < strips.size()) strips_ = backend_.allocate(std::bit_ceil(strips.size()));
  backend_.upload(beams_, byte_view(batch.beams));
  backend_.upload(strips_, strips);
  params_.beams = static_cast<std::uint32_t>(batch.beams.size());
  params_.strips = static_cast<std::uint32_t>(batch.strips.size());
  params_.directions = static_cast<std::uint32_t>(uploaded_rows_);
  run<SweepPoints>(backend_, params_, {params_.beams, 1, 1}, beams_, strips_, tables_, points_);
  PendingDownload download = backend_.start_download(points_, batch.beams.size() * sizeof(SweptBeam));
  backend_.flush();
  return download;
}

std::vector<SweptBeam> SweepDevice::finish(PendingDownload download) {
  std::vector<SweptBeam> swept(download.bytes / sizeof(SweptBeam));
  backend_.finish_download(std::move(download), std::as_writable_bytes(std::span(swept)));
  return swept;
}

std::optional<std::uint32_t> BeamDirections::find_row(const LaserScan& scan) {
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

std::vector<ScanStrip> make_strips(const ScanMotion& motion) {
  std::vector<ScanStrip> strips;
  StripCutter cutter(motion);
  for (std::size_t first = 0; first < motion.beams;) {
    strips.push_back(cutter.strip_from(first));
    first += strips.back().count;
  }
  return strips;
}

}  // namespace gdtslam
