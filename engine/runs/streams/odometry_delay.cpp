#include "odometry_delay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/core/angle.hpp"
#include "scan_stream.hpp"

namespace gdtslam {
namespace {

constexpr double kMostDelay_s = 1.5;
constexpr double kDelayStep_s = 0.01;
constexpr double kLongestStep_s = 1.0;      // between scans
constexpr double kSlip_rad = 0.05;          // cap on a difference; larger if the noise is: this many
constexpr double kSlipNoises = 3.0;         // standard deviations of the differences
constexpr double kMedianOfNormal = 0.6745;  // median of the absolute value of a normal variable
constexpr double kLeastTurn_rad = 3.0;      // least sum over all steps for an estimate
constexpr std::size_t kMostShifted = 512;
constexpr double kAround = 1.5;           // periods of the odometry on each side of the best shift: a parabola
constexpr std::size_t kFewestAround = 4;  // shifts
constexpr std::size_t kMostAround = 40;
constexpr std::size_t kTenths = 10;      // parts of the log; each is left out once
constexpr double kLeastSigma_s = 0.002;  // error of straight lines between stamps
constexpr double kLeastWalk_s = 1.0e-6;  // least variation of the smoothing that differs from a parabola

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
  /// A heading on the track.
  struct Place {
    double heading_rad = 0.0;
    std::size_t after = 0;  ///< index of the later of the two points around it
    double share = 0.0;     ///< share of the way from the earlier point
  };
  /// Returns none outside of the track and in its gaps.
  [[nodiscard]] std::optional<Place> at(double stamp_s) const {
    const auto after = std::lower_bound(points_.begin(), points_.end(), std::pair(stamp_s, -1e300));
    if (after == points_.begin() || after == points_.end()) return std::nullopt;
    const auto before = std::prev(after);
    const double span_s = after->first - before->first;
    if (span_s > kLongestStep_s) return std::nullopt;
    const double share = (stamp_s - before->first) / span_s;
    return Place{before->second + (after->second - before->second) * share,
                 static_cast<std::size_t>(after - points_.begin()), share};
  }
  /// Variance of the turn from one place to a later one if headings walk at random with unit variance a second. Less
  /// than the time between them for places within a step: a share of a step has that share of its error.
  [[nodiscard]] double walk_s(const Place& from, const Place& to) const {
    const auto span_s = [&](std::size_t after) { return points_[after].first - points_[after - 1].first; };
    const auto part = [&](double share, std::size_t after) { return share * share * span_s(after); };
    if (from.after == to.after) return part(to.share - from.share, to.after);
    const double whole_s = points_[to.after - 1].first - points_[from.after].first;
    return part(1.0 - from.share, from.after) + whole_s + part(to.share, to.after);
  }

 private:
  std::vector<std::pair<double, double>> points_;
};

/// Disagreement of turns by scans and by odometry at a shift.
struct Agreement {
  double sum = 0.0;   ///< sum of squared differences, capped for slips, rad^2
  double walk = 0.0;  ///< sum of HeadingTrack::walk_s()
  std::size_t steps = 0;
  [[nodiscard]] double mean() const {
    return steps > 0 ? sum / static_cast<double>(steps) : std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] double mean_walk_s() const { return walk / static_cast<double>(steps); }
  void add(const Agreement& other, double sign) {
    sum += sign * other.sum;
    walk += sign * other.walk;
    steps = sign > 0.0 ? steps + other.steps : steps - other.steps;
  }
};

/// Agreement in the parts of a log one after the other, and in all.
struct Agreements {
  std::array<Agreement, kTenths> of_parts;
  Agreement all;
  [[nodiscard]] Agreement without(std::size_t part) const {
    Agreement rest = all;
    rest.add(of_parts[part], -1.0);
    return rest;
  }
};

/// A part of the log whose clock goes forward.
struct Stretch {
  std::vector<TimedHeading> headings;
  HeadingTrack odometry;
  [[nodiscard]] std::size_t part_with(std::size_t step) const { return step * kTenths / headings.size(); }
};

/// A step between two scans: its turn by the scans minus its turn by odometry, and its HeadingTrack::walk_s().
struct TurnOff {
  double rad = 0.0;
  double walk_s = 0.0;
};

std::optional<TurnOff> turn_off(const Stretch& stretch, std::size_t step, double shift_s) {
  const TimedHeading& from = stretch.headings[step - 1];
  const TimedHeading& to = stretch.headings[step];
  if (!(to.stamp_s > from.stamp_s && to.stamp_s - from.stamp_s <= kLongestStep_s)) return std::nullopt;
  const std::optional<HeadingTrack::Place> odometry_from = stretch.odometry.at(from.stamp_s + shift_s);
  const std::optional<HeadingTrack::Place> odometry_to = stretch.odometry.at(to.stamp_s + shift_s);
  if (!odometry_from || !odometry_to) return std::nullopt;
  const double by_odometry_rad = odometry_to->heading_rad - odometry_from->heading_rad;
  return TurnOff{wrap_angle(to.by_scans_rad - from.by_scans_rad) - by_odometry_rad,
                 stretch.odometry.walk_s(*odometry_from, *odometry_to)};
}

double capped_square(double off_rad, double slip_rad) { return std::min(off_rad * off_rad, slip_rad * slip_rad); }

// A turn that the wheels missed must stand out from their noise. Most steps turn little and show that noise.
double estimate_slip(const std::vector<Stretch>& stretches) {
  std::vector<double> off_rad;
  for (const Stretch& stretch : stretches) {
    for (std::size_t i = 1; i < stretch.headings.size(); ++i) {
      if (const std::optional<TurnOff> off = turn_off(stretch, i, 0.0)) off_rad.push_back(std::fabs(off->rad));
    }
  }
  if (off_rad.empty()) return kSlip_rad;
  const auto middle = off_rad.begin() + static_cast<std::ptrdiff_t>(off_rad.size() / 2);
  std::nth_element(off_rad.begin(), middle, off_rad.end());
  return std::max(kSlip_rad, kSlipNoises * *middle / kMedianOfNormal);
}

Agreements agreements_at(const std::vector<Stretch>& stretches, double shift_s, double slip_rad) {
  Agreements agreements;
  for (const Stretch& stretch : stretches) {
    for (std::size_t i = 1; i < stretch.headings.size(); ++i) {
      const std::optional<TurnOff> off = turn_off(stretch, i, shift_s);
      if (!off) continue;
      const Agreement agreement{capped_square(off->rad, slip_rad), off->walk_s, 1};
      agreements.all.add(agreement, 1.0);
      agreements.of_parts[stretch.part_with(i)].add(agreement, 1.0);
    }
  }
  return agreements;
}

// A clock that was set back begins a new stretch; a stamp far ahead of both neighbours is left out.
std::vector<std::vector<TimedHeading>> split_stretches(std::span<const TimedHeading> headings) {
  std::vector<std::vector<TimedHeading>> stretches(1);
  double latest_s = -std::numeric_limits<double>::infinity();
  std::size_t past = 0;  // number of last headings in a row that go forward but are before the latest
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

// The minimum of a parabola through the disagreement at shifts around the best one, in shifts from the first. Least
// squares with four unknowns: constant, slope, bend, and the share of the rest that is a random walk of the odometry.
// Between two of its stamps that walk is smoothed, which looks like a better shift by up to half a period.
std::optional<double> find_lowest(std::span<const Agreement> around) {
  const auto count = static_cast<double>(around.size());
  const double middle = 0.5 * (count - 1.0);
  std::vector<Tangent2> rows;
  std::vector<double> left;
  Tangent2 mean_row{};
  double mean_left = 0.0;
  for (std::size_t k = 0; k < around.size(); ++k) {
    if (around[k].steps == 0) return std::nullopt;
    const double x = (static_cast<double>(k) - middle) / middle;
    rows.push_back({x, x * x, around[k].mean_walk_s()});
    left.push_back(around[k].mean());
    for (std::size_t i = 0; i < 3; ++i) mean_row[i] += rows.back()[i] / count;
    mean_left += left.back() / count;
  }
  Matrix3 squares = Matrix3::diagonal(0.0, 0.0, square(kLeastWalk_s));
  Tangent2 right{};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) rows[k][i] -= mean_row[i];
    squares += outer(rows[k], rows[k]);
    for (std::size_t i = 0; i < 3; ++i) right[i] += rows[k][i] * (left[k] - mean_left);
  }
  const Tangent2 found = inverse(squares) * right;
  if (!(found[1] > 0.0)) return std::nullopt;
  const double lowest = -0.5 * found[0] / found[1];
  if (!(std::fabs(lowest) <= 1.0)) return std::nullopt;
  return middle * (1.0 + lowest);
}

/// The lowest shift, and its standard deviation by leaving out a part of the log at a time [Efron1982].
struct Lowest {
  double at = 0.0;
  double sigma = 0.0;
};
std::optional<Lowest> lowest_with_sigma(std::span<const Agreements> around) {
  std::vector<Agreement> of_all;
  for (const Agreements& at : around) of_all.push_back(at.all);
  const std::optional<double> whole = find_lowest(of_all);
  if (!whole) return std::nullopt;
  double squares = 0.0;
  for (std::size_t part = 0; part < kTenths; ++part) {
    std::vector<Agreement> rest;
    for (const Agreements& at : around) rest.push_back(at.without(part));
    const std::optional<double> without = find_lowest(rest);
    if (!without) return std::nullopt;
    squares += square(*without - *whole);
  }
  constexpr double kOfSquares = static_cast<double>(kTenths - 1) / static_cast<double>(kTenths);
  return Lowest{*whole, std::sqrt(kOfSquares * squares)};
}

// Shifts on each side of the best one to fit the parabola to: not beyond half of the rise, because capped slips bend
// the curve there.
std::size_t shifts_around(std::span<const TimedHeading> headings, std::span<const Agreements> at, std::size_t best) {
  double sum_s = 0.0;
  double steps = 0.0;
  for (std::size_t i = 1; i < headings.size(); ++i) {
    const double step_s = headings[i].stamp_s - headings[i - 1].stamp_s;
    if (!(step_s > 0.0 && step_s <= kLongestStep_s)) continue;
    sum_s += step_s;
    steps += 1.0;
  }
  const double shifts = steps > 0.0 ? std::ceil(kAround * sum_s / steps / kDelayStep_s) : 0.0;
  double most = 0.0;
  for (const Agreements& shift : at) {
    if (shift.all.steps > 0) most = std::max(most, shift.all.mean());
  }
  const double half_up = 0.5 * (at[best].all.mean() + most);
  std::size_t around = std::clamp(static_cast<std::size_t>(shifts), kFewestAround, kMostAround);
  const auto is_high = [&](std::size_t shift) { return shift < at.size() && at[shift].all.mean() > half_up; };
  while (around > kFewestAround && (is_high(best - around) || is_high(best + around))) --around;
  return around;
}

template <class AgreementOf>
std::size_t best_shift(const std::vector<Agreements>& at, const AgreementOf& agreement_of) {
  std::size_t best = at.size() / 2;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (agreement_of(at[k]).mean() < agreement_of(at[best]).mean()) best = k;
  }
  return best;
}

// Cross-validation: each tenth of the log is judged at the delay found from the others, and compared with no delay. A
// shift either way smooths the noise of the odometry between two stamps, but a delay is one way only. So the same shift
// the other way replaces no delay if it leaves smaller differences.
double measure_gain(const std::vector<Stretch>& stretches, const std::vector<Agreements>& at, std::size_t best,
                    double slip_rad) {
  const std::size_t none = at.size() / 2;
  const std::size_t mirrored = at.size() - 1 - best;
  const auto shift_s = [&](std::size_t k) {
    return (static_cast<double>(k) - static_cast<double>(none)) * kDelayStep_s;
  };
  const double without_s = shift_s(at[none].all.mean() < at[mirrored].all.mean() ? none : mirrored);
  std::array<double, kTenths> with_s{};
  for (std::size_t part = 0; part < kTenths; ++part) {
    with_s[part] = shift_s(best_shift(at, [&](const Agreements& shift) { return shift.without(part); }));
  }
  double sum = 0.0;
  double squares = 0.0;
  for (const Stretch& stretch : stretches) {
    for (std::size_t i = 1; i < stretch.headings.size(); ++i) {
      const std::optional<TurnOff> with = turn_off(stretch, i, with_s[stretch.part_with(i)]);
      const std::optional<TurnOff> without = turn_off(stretch, i, without_s);
      if (!with || !without) continue;
      const double less = capped_square(without->rad, slip_rad) - capped_square(with->rad, slip_rad);
      sum += less;
      squares += square(less);
    }
  }
  return squares > 0.0 ? sum / std::sqrt(squares) : 0.0;
}

}  // namespace

std::optional<OdometryDelay> estimate_delay(std::span<const TimedHeading> headings) {
  if (turned_rad(headings) < kLeastTurn_rad) return std::nullopt;
  std::vector<Stretch> stretches;
  for (std::vector<TimedHeading>& stretch : split_stretches(headings)) {
    HeadingTrack odometry(stretch);
    stretches.push_back({std::move(stretch), std::move(odometry)});
  }
  const double slip_rad = estimate_slip(stretches);
  const int most = static_cast<int>(kMostDelay_s / kDelayStep_s);
  std::vector<Agreements> at;
  at.reserve(2 * static_cast<std::size_t>(most) + 1);
  for (int k = -most; k <= most; ++k) at.push_back(agreements_at(stretches, k * kDelayStep_s, slip_rad));
  const std::size_t best = best_shift(at, [](const Agreements& shift) { return shift.all; });
  const std::size_t around = shifts_around(headings, at, best);
  if (best < around || best + around >= at.size())
    return std::nullopt;  // the best shift is outside of the search range
  const std::optional<Lowest> lowest = lowest_with_sigma(std::span(at).subspan(best - around, 2 * around + 1));
  if (!lowest) return std::nullopt;
  const double shift = static_cast<double>(best) - static_cast<double>(around) + lowest->at - most;
  return OdometryDelay{.delay_s = shift * kDelayStep_s,
                       .sigma_s = std::sqrt(square(lowest->sigma * kDelayStep_s) + square(kLeastSigma_s)),
                       .gain = measure_gain(stretches, at, best, slip_rad)};
}

std::vector<TimedHeading> to_headings(std::span<const TimedMotion> motions) {
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
  // A single stamp far in the past is wild: its scan is placed one step after the previous one.
  if (track_.is_in_doubt()) waiting.stamp_s = track_.back().stamp_s + track_.usual_step_s();
  waiting_.push_back(std::move(waiting));
  if (track_.has_past()) return;
  if (taken == OdometryTrack::Taken::kForgot || taken == OdometryTrack::Taken::kSetBack) place_again();
  for (Waiting& placed : waiting_) placed.is_placed = true;
}

// The last poses have right stamps; the poses that the track forgot because of them are placed one step earlier.
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
