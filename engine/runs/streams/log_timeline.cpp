#include "log_timeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <variant>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam {
namespace {

// Ranges between powers of two in equal parts: 3 % of the range at the most.
constexpr std::size_t kParts = 32;
constexpr int kLeastPower = -5;  // 3 cm
constexpr int kMostPower = 10;   // 1 km
constexpr std::size_t kTimelineRanges = kParts * static_cast<std::size_t>(kMostPower - kLeastPower);

constexpr double kLongestLog_s = 2.0e6;  // three weeks; a scan stamped farther away has a wrong stamp
constexpr std::uint64_t kStraysBelieved = 20;
constexpr std::uint64_t kScansForRate = 8;
constexpr std::uint64_t kScansForRest = 2;
constexpr std::uint64_t kElevationsEach = 2;
constexpr std::size_t kMostDrawn = 512;
constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();

std::size_t range_bin(double range_m) {
  int power = 0;
  const double half_to_one = std::frexp(range_m, &power);
  if (power - 1 < kLeastPower) return 0;
  if (power - 1 >= kMostPower) return kTimelineRanges - 1;
  const auto octave = static_cast<std::size_t>(power - 1 - kLeastPower);
  return kParts * octave + static_cast<std::size_t>((2.0 * half_to_one - 1.0) * static_cast<double>(kParts));
}

// A constant is told to the centimetre, and may lie in the bin before or behind.
void clear_around(double constant_m, std::vector<std::uint32_t>& returns) {
  constexpr double kRounded_m = 0.005;
  const std::size_t last = range_bin(constant_m + kRounded_m);
  for (std::size_t bin = range_bin(constant_m - kRounded_m); bin <= last; ++bin) returns[bin] = 0;
}

/// Where a bin begins.
double range_of_bin(std::size_t bin) {
  const double part = static_cast<double>(bin % kParts) / static_cast<double>(kParts);
  return std::ldexp(1.0 + part, static_cast<int>(bin / kParts) + kLeastPower);
}

std::uint64_t count_of(const std::vector<std::uint32_t>& returns) {
  return std::accumulate(returns.begin(), returns.end(), std::uint64_t{0});
}

/// Along a straight line within the bin.
double quantile_of(const std::vector<std::uint32_t>& returns, std::uint64_t total, double share) {
  const double wanted = share * static_cast<double>(total);
  double below = 0.0;
  for (std::size_t k = 0; k < returns.size(); ++k) {
    const auto here = static_cast<double>(returns[k]);
    if (here > 0.0 && below + here >= wanted) {
      return range_of_bin(k) + (range_of_bin(k + 1) - range_of_bin(k)) * (wanted - below) / here;
    }
    below += here;
  }
  return kNoFigure;
}

}  // namespace

void LogTimeline::Bin::add(const Bin& other) {
  scans += other.scans;
  latest = std::max(latest, other.latest);
  beams += other.beams;
  driven_s += other.driven_s;
  path_m += other.path_m;
  turn_rad += other.turn_rad;
  if (other.elevations > 0) {
    least_elevation_rad =
        elevations > 0 ? std::min(least_elevation_rad, other.least_elevation_rad) : other.least_elevation_rad;
    most_elevation_rad =
        elevations > 0 ? std::max(most_elevation_rad, other.most_elevation_rad) : other.most_elevation_rad;
  }
  elevations += other.elevations;
  if (returns.empty()) {
    returns = other.returns;
  } else {
    for (std::size_t k = 0; k < other.returns.size(); ++k) returns[k] += other.returns[k];
  }
}

void LogTimeline::halve() {
  for (std::size_t k = 0; k < bins_.size(); ++k) {
    if (k % 2 == 1) {
      bins_[k / 2].add(bins_[k]);
    } else if (k > 0) {
      bins_[k / 2] = std::move(bins_[k]);
    }
  }
  bins_.resize((bins_.size() + 1) / 2);
  width_ *= 2.0;
}

// Stamps that step back a little stay where they say; before the first scan is its place.
LogTimeline::Bin* LogTimeline::bin_at(double place_along) {
  const double after_s = std::max(0.0, place_along - *start_s_);
  while (after_s >= width_ * static_cast<double>(kMostBins)) halve();
  const auto place = static_cast<std::size_t>(after_s / width_);
  if (place >= bins_.size()) bins_.resize(place + 1);
  return &bins_[place];
}

void LogTimeline::add(const LogRecord& record) {
  if (const auto* scan = std::get_if<ScanRecord>(&record)) return add_scan(*scan);
  if (along_ == Along::kScans) return;
  const auto is_near = [this](double stamp_s) { return start_s_ && std::fabs(stamp_s - *start_s_) < kLongestLog_s; };
  if (const auto* odometry = std::get_if<Odometry>(&record)) {
    if (!has_scans_odometry_ && is_near(odometry->stamp_s)) add_odometry(odometry->stamp_s, odometry->T_odom_base);
  } else if (const auto* tilt = std::get_if<Tilt>(&record)) {
    if (is_near(tilt->stamp_s)) add_elevation(*tilt);
  }
}

void LogTimeline::add_scan(const ScanRecord& record) {
  const LaserScan& scan = record.scan;
  if (along_ == Along::kScans) return add_ranges(scan, static_cast<double>(scans_++));
  if (!start_s_) start_s_ = scan.stamp_s;
  if (std::fabs(scan.stamp_s - *start_s_) >= kLongestLog_s) {
    ++strays_;
    if (++strays_in_row_ < kStraysBelieved) return;
    // The first ones were wrong.
    strays_ = std::accumulate(bins_.begin(), bins_.end(), strays_ - 1,
                              [](std::uint64_t sum, const Bin& bin) { return sum + bin.scans; });
    bins_.clear();
    width_ = kFirstWidth_s;
    start_s_ = scan.stamp_s;
    last_ = 0.0;
    last_odometry_.reset();
  }
  strays_in_row_ = 0;
  if (record.T_odom_base) {
    if (!has_scans_odometry_) last_odometry_.reset();
    has_scans_odometry_ = true;
    add_odometry(scan.stamp_s, *record.T_odom_base);
  }
  add_ranges(scan, scan.stamp_s);
}

void LogTimeline::add_ranges(const LaserScan& scan, double place) {
  if (!start_s_) start_s_ = place;
  last_ = std::max(last_, place - *start_s_);
  Bin& bin = *bin_at(place);
  ++bin.scans;
  bin.latest = std::max(bin.latest, place - *start_s_);
  bin.beams += scan.ranges_m.size();
  bin.returns.resize(kTimelineRanges);
  for (const float range : scan.ranges_m) {
    const auto range_m = static_cast<double>(range);
    const bool is_return = std::isfinite(range_m) && range_m > 0.0 && !scan.is_at_limit(range_m);
    if (is_return) ++bin.returns[range_bin(range_m)];
  }
}

void LogTimeline::add_odometry(double stamp_s, const Pose2& T_odom_base) {
  if (!T_odom_base.is_finite()) return;
  if (last_odometry_) {
    const double step_s = stamp_s - last_odometry_->stamp_s;
    const Pose2 step = between(last_odometry_->T_odom_base, T_odom_base);
    if (step_s > 0.0 && !is_impossible(step, step_s, bounds_)) {
      Bin& bin = *bin_at(stamp_s);
      bin.driven_s += step_s;
      bin.path_m += step.translation().norm();
      bin.turn_rad += step.theta_rad;
    }
  }
  last_odometry_ = {stamp_s, T_odom_base};
}

void LogTimeline::add_elevation(const Tilt& tilt) {
  if (!std::isfinite(tilt.elevation_rad)) return;
  Bin one;
  one.elevations = 1;
  one.least_elevation_rad = one.most_elevation_rad = tilt.elevation_rad;
  bin_at(tilt.stamp_s)->add(one);
}

/// Bins joined until each has so many of something on average, and few enough for a picture.
std::vector<LogTimeline::Bin> LogTimeline::bins_for(std::uint64_t Bin::*what, std::uint64_t each) const {
  std::uint64_t total = 0;
  for (const Bin& bin : bins_) total += bin.*what;
  std::size_t joined = 1;
  while (joined < bins_.size() && (bins_.size() / joined > kMostDrawn || total * joined < each * bins_.size())) {
    joined *= 2;
  }
  std::vector<Bin> bins((bins_.size() + joined - 1) / joined);
  for (std::size_t k = 0; k < bins_.size(); ++k) bins[k / joined].add(bins_[k]);
  return bins;
}

double LogTimeline::width_of(const std::vector<Bin>& bins) const {
  double width_s = width_;
  for (std::size_t many = bins_.size(); many > bins.size(); many = (many + 1) / 2) width_s *= 2.0;
  return width_s;
}

// From the last scan of a bin to that of the next one: a scan on either side of a bin's end would be one of eight.
void LogTimeline::set_rates(LogPicture& picture, const LogCheck& check) const {
  const std::vector<Bin> bins = bins_for(&Bin::scans, kScansForRate);
  const double width_s = width_of(bins);
  double before_s = -check.median_step_s;
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const double from_s = static_cast<double>(k) * width_s;
    const bool is_too_short = k > 0 && last_ - from_s < 0.5 * width_s;
    if (is_too_short) break;
    const double took_s = bins[k].latest - before_s;
    const bool is_known = bins[k].scans > 0 && took_s > 0.0;
    picture.rates_hz.emplace_back(from_s, is_known ? static_cast<double>(bins[k].scans) / took_s : 0.0);
    before_s = bins[k].scans > 0 ? bins[k].latest : from_s + width_s;
  }
  picture.rates_hz.emplace_back(picture.length, picture.rates_hz.back().y());
}

void LogTimeline::set_motion(LogPicture& picture, const std::vector<Bin>& bins) const {
  const bool has_odometry = std::any_of(bins.begin(), bins.end(), [](const Bin& bin) { return bin.driven_s > 0.0; });
  if (!has_odometry) return;
  const double width_s = width_of(bins);
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const Bin& bin = bins[k];
    const double at_s = (static_cast<double>(k) + 0.5) * width_s;
    const bool is_known = bin.driven_s > 0.0;
    picture.speeds_m_s.emplace_back(at_s, is_known ? bin.path_m / bin.driven_s : kNoFigure);
    picture.turns_deg_s.emplace_back(at_s, is_known ? deg_from_rad(bin.turn_rad) / bin.driven_s : kNoFigure);
  }
}

void LogTimeline::set_elevations(LogPicture& picture) const {
  const std::vector<Bin> bins = bins_for(&Bin::elevations, kElevationsEach);
  const bool has_any = std::any_of(bins.begin(), bins.end(), [](const Bin& bin) { return bin.elevations > 0; });
  if (!has_any) return;
  const double width_s = width_of(bins);
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const Bin& bin = bins[k];
    const double at_s = (static_cast<double>(k) + 0.5) * width_s;
    const auto degrees = [&](double angle_rad) { return bin.elevations > 0 ? deg_from_rad(angle_rad) : kNoFigure; };
    picture.elevations_deg.emplace_back(Point2(at_s, degrees(bin.least_elevation_rad)),
                                        Point2(at_s, degrees(bin.most_elevation_rad)));
  }
}

void LogTimeline::set_ranges(LogPicture& picture, std::vector<Bin> bins, const LogCheck& check) const {
  const double width_s = width_of(bins);
  for (std::size_t k = 0; k < bins.size(); ++k) {
    Bin& bin = bins[k];
    const double at_s = (static_cast<double>(k) + 0.5) * width_s;
    if (!bin.returns.empty()) {
      for (const double constant_m : check.ranges.no_return_m) clear_around(constant_m, bin.returns);
    }
    const std::uint64_t returns = count_of(bin.returns);
    const double missing = 100.0 * static_cast<double>(bin.beams - returns) / static_cast<double>(bin.beams);
    picture.missing_percent.emplace_back(at_s, bin.beams > 0 ? missing : kNoFigure);
    const auto quantile = [&](double share) { return quantile_of(bin.returns, returns, share); };
    picture.ranges.push_back({at_s, quantile(0.05), quantile(0.25), quantile(0.5), quantile(0.75), quantile(0.95)});
  }
}

void LogTimeline::set_events(LogPicture& picture, const LogCheck& check) const {
  for (const LogEvent& gap : check.gaps.first) {
    const double to_s = gap.stamp_s - *start_s_;
    if (to_s > 0.0 && to_s <= last_) picture.gaps_s.emplace_back(to_s - gap.time_step_s, to_s);
  }
  for (const LogEvent& jump : check.impossible_steps.first) {
    const double at_s = jump.stamp_s - *start_s_;
    if (at_s >= 0.0 && at_s <= last_) picture.jumps_s.push_back(at_s);
  }
}

std::string LogTimeline::subtitle(const LogCheck& check) const {
  std::string text = counted(check.scans, "scan");
  text += along_ == Along::kTime ? fmt::format(" in {:.1f} s", last_) : ", all of one stamp: drawn by their numbers";
  if (check.path_m > 0.0) {
    text +=
        fmt::format("; {:.1f} m driven, {:.0f} deg turned by odometry", check.path_m, deg_from_rad(check.turned_rad));
  } else {
    const bool has_odometry = check.scans_with_odometry + check.odometry_records > 0;
    text += has_odometry ? "; the odometry stands still" : "; no odometry";
  }
  if (check.gaps.count > 0) {
    text += fmt::format("; {} longer than {:.1f} s", counted(check.gaps.count, "gap"), check.gap_bound_s);
    const bool are_more = check.gaps.count > EventList::kMostListed;
    if (are_more) text += fmt::format(" (the longest {} are marked)", EventList::kMostListed);
  }
  if (strays_ > 0) text += fmt::format("; {} stamped weeks away left out", counted(strays_, "scan"));
  return text;
}

LogPicture LogTimeline::picture(const LogCheck& check, const std::string& title) const {
  LogPicture picture;
  picture.title = title;
  picture.subtitle = subtitle(check);
  picture.is_by_time = along_ == Along::kTime;
  picture.length = last_ > 0.0 ? last_ : 1.0;
  if (!start_s_) return picture;
  const std::vector<Bin> bins = bins_for(&Bin::scans, kScansForRest);
  set_ranges(picture, bins, check);
  if (along_ == Along::kScans) return picture;
  set_rates(picture, check);
  set_motion(picture, bins);
  set_elevations(picture);
  set_events(picture, check);
  return picture;
}

}  // namespace gdtslam
