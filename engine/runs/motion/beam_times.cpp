#include "beam_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "engine/mapping/adjust/point_to_line.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "scan_speed.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostPaired = 10;   // scans paired with a scan: farther ones see other places
constexpr std::size_t kMostPairs = 200;   // more pairs change nothing
constexpr std::size_t kFewestPairs = 40;  // four in each tenth
constexpr double kRateChange_rad_per_s = 0.3;
constexpr std::size_t kPairTenths = 10;
constexpr std::size_t kFewestBetter = 9;
constexpr double kLeastGain = 0.02;           // gain in the share of points
constexpr double kLeastOff_s = 0.02;          // a degree at 1 rad/s
constexpr double kSigmas = 5.0;               // beyond chance
constexpr double kLeastSweepSigma_s = 0.002;  // the speed is not constant within a sweep
constexpr double kRoundShare =
    0.1;                    // share of the log's sweep: a result this near to its reverse, or to zero, is rounded to it
constexpr int kCoarse = 3;  // half periods of the scans to each side
constexpr int kHalvings = 4;          // halvings of that step: to a 32nd of a period
constexpr double kFewestLaid = 15.0;  // least points to match a scan with another
constexpr double kHold = 0.01;        // information of a point along directions without a surface

LineScan swept(LaserScan scan, double sweep_s, const ScanConfig& valid) {
  scan.first_beam_after_s = -0.5 * sweep_s;
  scan.beam_period_s = sweep_s / std::max(1.0, static_cast<double>(scan.ranges_m.size()) - 1.0);
  return LineScan(keep_scan(to_points(scan, valid)));
}

// Weighted share of the points of one scan that lie on the surfaces of the other after matching.
double share_laid(const LineScan& fixed, const LineScan& moving, Pose2 T_fixed_moving) {
  constexpr LineGate kWide{.most_m = 0.3};
  constexpr LineGate kNarrow{};
  constexpr int kSteps = 3;  // with each
  for (int k = 0; k < 2 * kSteps; ++k) {
    const LineEquations lines = line_equations(fixed, moving, T_fixed_moving, k < kSteps ? kWide : kNarrow);
    if (lines.weight < kFewestLaid) return 0.0;
    const double hold = kHold * lines.weight;
    const Tangent2 back = inverse(lines.information + Matrix3::diagonal(hold, hold, hold)) * lines.gradient;
    T_fixed_moving = T_fixed_moving * exp_tangent({-back[0], -back[1], -back[2]});
  }
  const std::size_t every = std::max<std::size_t>(1, moving.size() / kNarrow.points);
  const std::size_t taken = (moving.size() + every - 1) / every;
  return line_equations(fixed, moving, T_fixed_moving, kNarrow).weight / static_cast<double>(taken);
}

/// Shares of the points, summed over the pairs, and over each tenth of them.
struct Shares {
  std::array<double, kPairTenths> of_tenths{};
  double all = 0.0;
};

/// One value at the best sweep, and a step to each side.
struct Around {
  double before = 0.0;
  double there = 0.0;
  double after = 0.0;
  /// Maximum of the parabola through the values, in steps; not finite if it has none.
  [[nodiscard]] double highest() const {
    const double bend = before - 2.0 * there + after;
    return bend < 0.0 ? 0.5 * (before - after) / bend : std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] double at(double steps) const {
    return there + 0.5 * steps * (after - before) + 0.5 * steps * steps * (before - 2.0 * there + after);
  }
};

double logged_sweep(const LaserScan& scan) {
  return scan.beam_period_s * std::max(0.0, static_cast<double>(scan.ranges_m.size()) - 1.0);
}

// Drivers reverse a scan or invent its times, so the reverse of the log's sweep and zero are likelier than others.
double rounded(const BeamTimes& found) {
  const double near_s = std::max(3.0 * found.sigma_s, kRoundShare * std::fabs(found.logged_sweep_s));
  if (std::fabs(found.sweep_s) < near_s) return 0.0;
  if (std::fabs(found.sweep_s + found.logged_sweep_s) < near_s) return -found.logged_sweep_s;
  return found.sweep_s;
}

std::string sweep_text(double sweep_s) {
  if (sweep_s == 0.0) return "all at once";
  return fmt::format("from the {} within {:.0f} ms", sweep_s > 0.0 ? "first to the last" : "last to the first",
                     1000.0 * std::fabs(sweep_s));
}

}  // namespace

bool BeamTimes::stands_out() const {
  return better_tenths >= kFewestBetter && share - logged_share > kLeastGain &&
         std::fabs(sweep_s - logged_sweep_s) > std::max(kLeastOff_s, kSigmas * sigma_s);
}

LogFinding BeamTimes::finding() const {
  const double stated_s = rounded(*this);
  const std::string logged = logged_sweep_s == 0.0 ? "which the log does not say"
                                                   : fmt::format("not {} as the log says", sweep_text(logged_sweep_s));
  return {.what = fmt::format("the beams of a scan were measured {}, {}", sweep_text(stated_s), logged),
          .evidence = fmt::format("of the points in turns {:.0f} % lie on other scans, {:.0f} % with the log's times; "
                                  "fitted {:.0f} ms, +-{:.0f} ms",
                                  100.0 * share, 100.0 * logged_share, 1000.0 * sweep_s, 1000.0 * sigma_s),
          .options = fmt::format("--set log.beam_times=stated --set log.first_beam_after={:.6g}ms --set "
                                 "log.beam_period={:.6g}ms",
                                 1000.0 * first_beam_after_s, 1000.0 * beam_period_s)};
}

void BeamTimes::state_in(ReadOptions& read) const {
  read.first_beam_after_s = first_beam_after_s;
  read.beam_period_s = beam_period_s;
}

void BeamTimesFit::add(const LaserScan& scan, const Pose2& T_map_base) {
  if (pairs_.size() == kMostPairs) return;
  if (!last_.empty()) periods_s_.push_back(scan.stamp_s - last_.back().scan.stamp_s);
  last_.push_back({scan, T_map_base});
  last_.back().scan.speed.reset();
  if (last_.size() > kMostPaired) last_.pop_front();
  if (last_.size() < 3) return;
  MovingScan& moving = last_[last_.size() - 2];
  const MovingScan& before = last_[last_.size() - 3];
  moving.scan.speed = speed_between({before.scan.stamp_s, before.T_map_base}, {scan.stamp_s, T_map_base});
  if (!moving.scan.speed) return;
  const MovingScan* fixed = nullptr;
  double most = kRateChange_rad_per_s;
  for (const MovingScan& other : last_) {
    if (!other.scan.speed) continue;
    const double change = std::fabs((*moving.scan.speed)[2] - (*other.scan.speed)[2]);
    if (change <= most) continue;
    most = change;
    fixed = &other;
  }
  if (fixed != nullptr) pairs_.push_back({*fixed, moving});
}

/// Searches the sweep with the most points on the other scan: over three periods of the scans in steps, then between
/// neighbours by halving, and finally by a parabola.
class BeamTimesFit::Search {
 public:
  Search(const std::vector<Pair>& pairs, const ScanConfig& valid) : pairs_(pairs), valid_(valid) {}

  /// True if scans fit worse with a slightly shorter and with a slightly longer sweep.
  [[nodiscard]] bool is_best(double sweep_s) const {
    const double share = shares(sweep_s).all;
    return share > shares(sweep_s - kLeastOff_s).all && share > shares(sweep_s + kLeastOff_s).all;
  }

  /// False if scans fit best at the end of the search range.
  bool find(double period_s) {
    step_s_ = 0.5 * period_s;
    std::vector<Shares> at;
    std::size_t best = 0;
    for (int k = -kCoarse; k <= kCoarse; ++k) {
      at.push_back(shares(k * step_s_));
      if (at.back().all > at[best].all) best = at.size() - 1;
    }
    if (best == 0 || best + 1 == at.size()) return false;
    best_s_ = (static_cast<double>(best) - kCoarse) * step_s_;
    around_ = {at[best - 1], at[best], at[best + 1]};
    for (int k = 0; k < kHalvings; ++k) halve();
    return true;
  }

  /// Adds a standard deviation, by leaving out a tenth of the pairs at a time [Efron1982].
  [[nodiscard]] BeamTimes compared_with(double logged_sweep_s) const {
    BeamTimes found{.logged_sweep_s = logged_sweep_s};
    const Shares logged = shares(logged_sweep_s);
    const Around all{around_[0].all, around_[1].all, around_[2].all};
    double squares = 0.0;
    for (std::size_t k = 0; k < kPairTenths; ++k) {
      const Around own{around_[0].of_tenths[k], around_[1].of_tenths[k], around_[2].of_tenths[k]};
      const Around others{all.before - own.before, all.there - own.there, all.after - own.after};
      squares += square(others.highest() - all.highest());
      if (own.at(others.highest()) > logged.of_tenths[k]) ++found.better_tenths;
    }
    constexpr double kOfSquares = static_cast<double>(kPairTenths - 1) / static_cast<double>(kPairTenths);
    const auto pairs = static_cast<double>(pairs_.size());
    found.sweep_s = best_s_ + step_s_ * all.highest();
    found.sigma_s = std::sqrt(kOfSquares * squares * square(step_s_) + square(kLeastSweepSigma_s));
    found.share = all.there / pairs;
    found.logged_share = logged.all / pairs;
    return found;
  }

 private:
  void halve() {
    step_s_ *= 0.5;
    const Shares before = shares(best_s_ - step_s_);
    const Shares after = shares(best_s_ + step_s_);
    if (before.all > around_[1].all && before.all >= after.all) {
      around_ = {around_[0], before, around_[1]};
      best_s_ -= step_s_;
    } else if (after.all > around_[1].all) {
      around_ = {around_[1], after, around_[2]};
      best_s_ += step_s_;
    } else {
      around_ = {before, around_[1], after};
    }
  }

  [[nodiscard]] Shares shares(double sweep_s) const {
    Shares sum;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto& [fixed, moving] = pairs_[i];
      const double share = share_laid(swept(fixed.scan, sweep_s, valid_), swept(moving.scan, sweep_s, valid_),
                                      between(fixed.T_map_base, moving.T_map_base));
      sum.of_tenths[i * kPairTenths / pairs_.size()] += share;
      sum.all += share;
    }
    return sum;
  }

  const std::vector<Pair>& pairs_;
  const ScanConfig& valid_;
  double best_s_ = 0.0;
  double step_s_ = 0.0;
  std::array<Shares, 3> around_{};  ///< one step before the best sweep, at it, and one step after
};

std::optional<BeamTimes> BeamTimesFit::fit(const ScanConfig& valid) const {
  if (pairs_.size() < kFewestPairs) return std::nullopt;
  std::vector<double> periods_s = periods_s_;
  const auto median = periods_s.begin() + static_cast<std::ptrdiff_t>(periods_s.size() / 2);
  std::nth_element(periods_s.begin(), median, periods_s.end());
  const LaserScan& scan = pairs_.back().moving.scan;
  Search search(pairs_, valid);
  if (search.is_best(logged_sweep(scan)) || !search.find(*median)) return std::nullopt;
  BeamTimes found = search.compared_with(logged_sweep(scan));
  if (!std::isfinite(found.sigma_s)) return std::nullopt;
  const double begin_s = scan.first_beam_after_s + std::min(0.0, found.logged_sweep_s);
  const double stated_s = rounded(found);
  found.first_beam_after_s = stated_s == 0.0 ? 0.0 : begin_s + std::max(0.0, -stated_s);
  found.beam_period_s = stated_s / std::max(1.0, static_cast<double>(scan.ranges_m.size()) - 1.0);
  return found;
}

}  // namespace gdtslam
