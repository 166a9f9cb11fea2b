#include "linkage_cycle.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::calib {
namespace {

constexpr int kSteps = 720;
constexpr int kAngleHalvings = 50;
constexpr double kWholeTurn = kTwoPi - 1e-6;

}  // namespace

Point2 unit_at(double angle_rad) {
  const SinCos<double> unit = sin_cos(angle_rad);
  return {unit.cos, unit.sin};
}

Point2 place_in_mount(const SweepModel& model, const Point2& place) {
  const SinCos<double> by = sin_cos(model.elevation_offset_rad);
  const double x = place.x() - model.bars.ground_m;
  const double y = model.elevation_sign * place.y();
  return {by.cos * x - by.sin * y, by.sin * x + by.cos * y};
}

std::optional<LinkagePosition> position_at(const SweepModel& model, double crank_rad) {
  const FourBar& bars = model.bars;
  const std::optional<LinkagePose> pose = solve(bars, model.assembly, crank_rad);
  const std::optional<double> elevation_rad = calib::elevation_rad(model, crank_rad);
  const auto middle = coupler_point(bars, model.assembly, crank_rad, 0.5 * bars.coupler_m, 0.0);
  if (!pose || !elevation_rad || !middle) return std::nullopt;
  const Point2 crank_end = bars.crank_m * unit_at(crank_rad);
  const Point2 coupler_end = crank_end + bars.coupler_m * unit_at(pose->coupler_rad);
  return LinkagePosition{.crank_rad = crank_rad,
                         .elevation_rad = *elevation_rad,
                         .pose = *pose,
                         .joints = {place_in_mount(model, Point2::Zero()), place_in_mount(model, crank_end),
                                    place_in_mount(model, coupler_end), Point2::Zero()},
                         .middle = place_in_mount(model, *middle)};
}

LinkageCycle::LinkageCycle(const SweepModel& model) : model_(model), grashof_(GrashofClass::kTripleRocker) {
  const std::vector<std::string> wrong = violations(model.bars);
  if (!wrong.empty()) throw ConfigError(wrong.front());
  grashof_ = grashof_class(model.bars);
  choose_span();
  for (int i = 0; i <= kSteps; ++i) {
    std::optional<LinkagePosition> position = position_at(model_, from_rad_ + span_rad_ * i / kSteps);
    if (!position) continue;
    if (!positions_.empty()) {
      const double last_rad = positions_.back().elevation_rad;
      position->elevation_rad = last_rad + wrap_angle(position->elevation_rad - last_rad);
    }
    positions_.push_back(*position);
  }
  if (positions_.empty()) throw ConfigError("the loop closes in no stretch of the crank's turn");
  centre_elevations();
  if (!turns_fully_) {
    // Rounding may leave the loop open at the very ends; the range ends at the positions found.
    from_rad_ = positions_.front().crank_rad;
    span_rad_ = positions_.back().crank_rad - from_rad_;
  }
  begin_ = positions_.front();
  const LinkagePosition lift_end = at(from_rad_ + lift_span_rad()).value_or(positions_.back());
  end_ = lift_end;
  if (report_) {
    const DeadPoint& dead = model_.elevation_sign > 0 ? report_->highest : report_->lowest;
    end_ = at(dead.crank_rad).value_or(lift_end);
  }
  // The end of the lift is included, so that every reachable elevation is between two of these.
  branches_ = positions_;
  const auto behind = std::find_if(branches_.begin(), branches_.end(), [&](const LinkagePosition& position) {
    return std::fabs(position.crank_rad - from_rad_) > std::fabs(lift_span_rad());
  });
  branches_.insert(behind, lift_end);
}

void LinkageCycle::choose_span() {
  if (grashof_ == GrashofClass::kCrankRocker) {
    report_ = analyse(model_.bars, model_.assembly);
    const bool is_rising = model_.elevation_sign > 0;
    from_rad_ = is_rising ? report_->lowest.crank_rad : report_->highest.crank_rad;
    span_rad_ = kTwoPi * report_->lift_direction * (is_rising ? 1 : -1);
  } else {
    const std::vector<CrankRange> ranges = crank_ranges(model_.bars);
    if (ranges.empty()) throw ConfigError("the loop closes at no crank angle");
    from_rad_ = ranges.front().from_rad;
    span_rad_ = ranges.front().to_rad - from_rad_;
  }
  turns_fully_ = std::fabs(span_rad_) >= kWholeTurn;
}

// Shifts the elevations by whole turns so that the middle of their range is a usual angle.
void LinkageCycle::centre_elevations() {
  lowest_rad_ = positions_.front().elevation_rad;
  highest_rad_ = lowest_rad_;
  for (const LinkagePosition& position : positions_) {
    lowest_rad_ = std::min(lowest_rad_, position.elevation_rad);
    highest_rad_ = std::max(highest_rad_, position.elevation_rad);
  }
  const double shift_rad = kTwoPi * std::floor((0.5 * (lowest_rad_ + highest_rad_) + kPi) / kTwoPi);
  for (LinkagePosition& position : positions_) position.elevation_rad -= shift_rad;
  lowest_rad_ -= shift_rad;
  highest_rad_ -= shift_rad;
}

bool LinkageCycle::sweeps_all_around() const { return highest_rad_ - lowest_rad_ >= kWholeTurn; }

double LinkageCycle::lift_span_rad() const { return report_ ? span_rad_ * report_->lift_share : span_rad_; }

std::optional<LinkagePosition> LinkageCycle::at(double crank_rad) const {
  std::optional<LinkagePosition> position = position_at(model_, crank_rad);
  if (!position) return std::nullopt;
  const double since_rad = since_begin_rad(crank_rad);
  const auto nearest = std::min_element(positions_.begin(), positions_.end(), [&](const auto& a, const auto& b) {
    return std::fabs(std::fabs(a.crank_rad - from_rad_) - since_rad) <
           std::fabs(std::fabs(b.crank_rad - from_rad_) - since_rad);
  });
  position->elevation_rad = nearest->elevation_rad + wrap_angle(position->elevation_rad - nearest->elevation_rad);
  return position;
}

std::vector<LinkagePosition> LinkageCycle::stretch(double span_rad, int steps) const {
  std::vector<LinkagePosition> reached;
  for (int i = 0; i <= steps; ++i) {
    if (const auto position = at(from_rad_ + span_rad * i / steps)) reached.push_back(*position);
  }
  return reached;
}

double LinkageCycle::crank_at(double share) const {
  if (turns_fully_) return from_rad_ + span_rad_ * share;
  return from_rad_ + span_rad_ * (share <= 0.5 ? 2.0 * share : 2.0 - 2.0 * share);
}

double LinkageCycle::since_begin_rad(double crank_rad) const {
  const double turned_rad = span_rad_ < 0.0 ? from_rad_ - crank_rad : crank_rad - from_rad_;
  const double since_rad = turned_rad - kTwoPi * std::floor(turned_rad / kTwoPi);
  // An angle just before the start counts as the start, not as a whole turn.
  return since_rad > kTwoPi - 1e-9 ? 0.0 : since_rad;
}

double LinkageCycle::crank_of(double elevation_rad, bool is_rising, int direction) const {
  // The elevation rises along the cycle if it rises in time, or if it falls and the crank turns the other way.
  const bool rises_along = is_rising == (direction * span_rad_ > 0.0);
  const auto above = [&](double rad) { return wrap_angle(rad - elevation_rad); };
  for (std::size_t i = 0; i + 1 < branches_.size(); ++i) {
    const double first = above(branches_[i].elevation_rad);
    const double second = first + (branches_[i + 1].elevation_rad - branches_[i].elevation_rad);
    if ((second > first) != rises_along || first == second || (first > 0.0) == (second > 0.0)) continue;
    double low_rad = branches_[i].crank_rad;
    double high_rad = branches_[i + 1].crank_rad;
    for (int k = 0; k < kAngleHalvings; ++k) {
      const double middle_rad = 0.5 * (low_rad + high_rad);
      const std::optional<double> there = calib::elevation_rad(model_, middle_rad);
      const bool is_before = there && (above(*there) > 0.0) == (first > 0.0);
      (is_before ? low_rad : high_rad) = middle_rad;
    }
    return 0.5 * (low_rad + high_rad);
  }
  return std::min_element(branches_.begin(), branches_.end(),
                          [&](const auto& a, const auto& b) {
                            return std::fabs(above(a.elevation_rad)) < std::fabs(above(b.elevation_rad));
                          })
      ->crank_rad;
}

double LinkageCycle::shown_crank_rad() const {
  const double lift_rad = std::fabs(lift_span_rad());
  const LinkagePosition* best = &positions_.front();
  double best_rad = -1.0;
  for (const LinkagePosition& position : positions_) {
    const double share = std::fabs(position.crank_rad - from_rad_) / lift_rad;
    if (share >= 0.2 && share <= 0.8 && position.pose.transmission_rad > best_rad) {
      best = &position;
      best_rad = position.pose.transmission_rad;
    }
  }
  return best->crank_rad;
}

}  // namespace gdtslam::calib
