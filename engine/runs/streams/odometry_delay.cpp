#include "odometry_delay.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gdtslam/core/angle.hpp"
#include "scan_stream.hpp"

namespace gdtslam {
namespace {

constexpr double kMostDelay_s = 1.5;
constexpr double kDelayStep_s = 0.01;
constexpr double kLongestStep_s = 1.0;  // between scans
constexpr double kSlip_rad = 0.05;      // beyond which a difference counts as this much
constexpr double kLeastTurn_rad = 3.0;  // of all steps, to tell anything
constexpr std::size_t kMostShifted = 512;

/// Headings by odometry over time, unwrapped; along straight lines between the stamps.
class HeadingTrack {
 public:
  explicit HeadingTrack(std::span<const TimedHeading> headings) {
    for (const TimedHeading& heading : headings) {
      if (!points_.empty() && !(heading.stamp_s > points_.back().first)) continue;
      const double last = points_.empty() ? heading.by_odometry_rad : points_.back().second;
      points_.emplace_back(heading.stamp_s, last + wrap_angle(heading.by_odometry_rad - last));
    }
  }
  /// Nothing outside of the track, and where it has a gap.
  [[nodiscard]] std::optional<double> at(double stamp_s) const {
    const auto after = std::lower_bound(points_.begin(), points_.end(), std::pair(stamp_s, -1e300));
    if (after == points_.begin() || after == points_.end()) return std::nullopt;
    const auto before = std::prev(after);
    const double span_s = after->first - before->first;
    if (span_s > kLongestStep_s) return std::nullopt;
    return before->second + (after->second - before->second) * (stamp_s - before->first) / span_s;
  }

 private:
  std::vector<std::pair<double, double>> points_;
};

/// How badly turns by scans and by odometry agree at a shift.
struct Agreement {
  double sum = 0.0;  ///< of squared differences, those of slips capped, rad^2
  std::size_t steps = 0;
  [[nodiscard]] double mean() const {
    return steps > 0 ? sum / static_cast<double>(steps) : std::numeric_limits<double>::infinity();
  }
};

void add_agreement(std::span<const TimedHeading> headings, const HeadingTrack& odometry, double shift_s,
                   Agreement& agreement) {
  for (std::size_t i = 1; i < headings.size(); ++i) {
    const TimedHeading& from = headings[i - 1];
    const TimedHeading& to = headings[i];
    if (!(to.stamp_s > from.stamp_s && to.stamp_s - from.stamp_s <= kLongestStep_s)) continue;
    const std::optional<double> odometry_from = odometry.at(from.stamp_s + shift_s);
    const std::optional<double> odometry_to = odometry.at(to.stamp_s + shift_s);
    if (!odometry_from || !odometry_to) continue;
    const double off = wrap_angle(to.by_scans_rad - from.by_scans_rad) - (*odometry_to - *odometry_from);
    agreement.sum += std::min(off * off, kSlip_rad * kSlip_rad);
    ++agreement.steps;
  }
}

// A clock that was set back begins a new stretch; a stamp far ahead of both its neighbours is left out.
std::vector<std::vector<TimedHeading>> stretches_of(std::span<const TimedHeading> headings) {
  std::vector<std::vector<TimedHeading>> stretches(1);
  double latest_s = -std::numeric_limits<double>::infinity();
  std::size_t past = 0;  // the last ones, in a row, that go forward behind the latest
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const double stamp_s = headings[i].stamp_s;
    const double before_s = i > 0 ? headings[i - 1].stamp_s : stamp_s;
    const double after_s = i + 1 < headings.size() ? headings[i + 1].stamp_s : stamp_s;
    if (stamp_s - before_s > kLongestStep_s && after_s > before_s && stamp_s - after_s > kLongestStep_s) continue;
    stretches.back().push_back(headings[i]);
    past = stamp_s > latest_s ? 0 : past > 0 && stamp_s <= before_s ? 1 : past + 1;
    latest_s = std::max(latest_s, stamp_s);
    if (past < OdometryTrack::kSetBack) continue;
    std::vector<TimedHeading>& ended = stretches.back();
    const auto first = ended.end() - static_cast<std::ptrdiff_t>(OdometryTrack::kSetBack);
    std::vector<TimedHeading> begun(first, ended.end());
    ended.erase(first, ended.end());
    stretches.push_back(std::move(begun));
    latest_s = stamp_s;
    past = 0;
  }
  return stretches;
}

double turned_rad(std::span<const TimedHeading> headings) {
  double sum = 0.0;
  for (std::size_t i = 1; i < headings.size(); ++i) {
    sum += std::fabs(wrap_angle(headings[i].by_scans_rad - headings[i - 1].by_scans_rad));
  }
  return sum;
}

}  // namespace

std::optional<OdometryDelay> delay_of(std::span<const TimedHeading> headings) {
  if (turned_rad(headings) < kLeastTurn_rad) return std::nullopt;
  const std::vector<std::vector<TimedHeading>> stretches = stretches_of(headings);
  const std::vector<HeadingTrack> odometry(stretches.begin(), stretches.end());
  const int most = static_cast<int>(kMostDelay_s / kDelayStep_s);
  std::vector<Agreement> at;
  at.reserve(2 * static_cast<std::size_t>(most) + 1);
  for (int k = -most; k <= most; ++k) {
    at.emplace_back();
    for (std::size_t i = 0; i < stretches.size(); ++i) {
      add_agreement(stretches[i], odometry[i], k * kDelayStep_s, at.back());
    }
  }
  std::size_t best = static_cast<std::size_t>(most);
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (at[k].mean() < at[best].mean()) best = k;
  }
  if (best == 0 || best + 1 == at.size()) return std::nullopt;  // agrees best beyond what is looked for
  const double before = at[best - 1].mean();
  const double here = at[best].mean();
  const double after = at[best + 1].mean();
  const double bend = before - 2.0 * here + after;
  if (!(bend > 0.0) || !std::isfinite(bend)) return std::nullopt;
  // Between two stamps the noise of the odometry is smoothed, whichever way it is shifted; a delay is one way only.
  const double without = std::min(at[static_cast<std::size_t>(most)].mean(), at[at.size() - 1 - best].mean());
  const double off_steps = 0.5 * (before - after) / bend;
  const double variance = 2.0 * here / (static_cast<double>(at[best].steps) * bend) * kDelayStep_s * kDelayStep_s;
  return OdometryDelay{.delay_s = (static_cast<double>(best) - most + off_steps) * kDelayStep_s,
                       .sigma_s = std::sqrt(variance),
                       .unexplained = here / without};
}

std::vector<TimedHeading> headings_of(std::span<const TimedMotion> motions) {
  std::vector<TimedHeading> headings;
  headings.reserve(motions.size());
  for (const TimedMotion& motion : motions) {
    headings.push_back({motion.stamp_s, motion.T_odom_base.theta_rad, motion.T_scans_base.theta_rad});
  }
  return headings;
}

void OdometryShift::take(ScanRecord scan) {
  Waiting waiting{.scan = std::move(scan)};
  if (!waiting.scan.T_odom_base) {
    waiting_.push_back(std::move(waiting));
    return;
  }
  const double stamp_s = waiting.scan.scan.stamp_s;
  const OdometryTrack::Taken taken = track_.take({stamp_s, *waiting.scan.T_odom_base});
  waiting.stretch = track_.stretch();
  waiting.stamp_s = stamp_s;
  waiting.is_placed = !track_.has_past();
  // Far in the past it is wild, if it stays alone: it was taken a step after the one before it.
  if (track_.is_in_doubt()) waiting.stamp_s = track_.back().stamp_s + track_.usual_step_s();
  waiting_.push_back(std::move(waiting));
  if (track_.has_past()) return;
  if (taken == OdometryTrack::Taken::kForgot || taken == OdometryTrack::Taken::kSetBack) place_again();
  for (Waiting& placed : waiting_) placed.is_placed = true;
}

// The last poses were right by their stamps; what the track has forgotten for them was taken a step before them.
void OdometryShift::place_again() {
  const double first_s = track_.first_after_set_back_s();
  bool is_right = true;
  for (auto it = waiting_.rbegin(); it != waiting_.rend(); ++it) {
    if (!it->scan.T_odom_base) continue;
    const double stamp_s = it->scan.scan.stamp_s;
    is_right = is_right && stamp_s >= first_s && (it == waiting_.rbegin() || !it->is_placed);
    if (is_right) {
      it->stretch = track_.stretch();
      it->stamp_s = stamp_s;
    } else if (it->stretch == track_.stretch() && it->stamp_s > track_.back().stamp_s) {
      it->stamp_s = first_s - track_.usual_step_s();
    }
  }
}

Pose2 OdometryShift::odometry_at(const Waiting& waiting) const {
  const double wanted_s = waiting.stamp_s + delay_s_;
  const auto [before, after] = track_.around(waiting.stretch, wanted_s);
  if (before == nullptr && after == nullptr) return *waiting.scan.T_odom_base;
  if (after == nullptr) return before->T_odom_base;
  if (before == nullptr) return after->T_odom_base;
  return interpolated(*before, *after, wanted_s);
}

std::optional<ScanRecord> OdometryShift::next(bool at_end) {
  if (waiting_.empty()) return std::nullopt;
  const Waiting& first = waiting_.front();
  const bool is_there =
      !first.scan.T_odom_base || (first.is_placed && track_.is_known(first.stretch, first.stamp_s + delay_s_));
  if (!is_there && !at_end && waiting_.size() < kMostShifted) return std::nullopt;
  Waiting given = std::move(waiting_.front());
  waiting_.pop_front();
  if (given.scan.T_odom_base) given.scan.T_odom_base = odometry_at(given);
  return std::move(given.scan);
}

}  // namespace gdtslam
