#include "gdtslam/mapping/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kShortTermLimit_s = 20.0;
constexpr double kClockStep_s = 1.0;  // a clock was set if it steps back by more than this

double yaw_error_deg(double a_rad, double b_rad) { return std::fabs(deg_from_rad(wrap_angle(a_rad - b_rad))); }

struct Errors {
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
  [[nodiscard]] RelationErrors summary() const { return {summarise(translation_m), summarise(rotation_deg)}; }
  void add(double metres, double degrees) {
    translation_m.push_back(metres);
    rotation_deg.push_back(degrees);
  }
};

struct MatchedPose {
  double stamp_s;
  Pose2 T_map_base;
  Pose2 T_reference_base;
};

// Least squares over rotation and translation without scale, in closed form for the plane [Umeyama1991]. If the robot
// stands, in truth or in the estimate, its positions do not determine the rotation, which then comes from the headings.
Pose2 rigid_alignment(const std::vector<MatchedPose>& matched) {
  const auto count = static_cast<double>(matched.size());
  Point2 mean_map = Point2::Zero();
  Point2 mean_reference = Point2::Zero();
  for (const MatchedPose& m : matched) {
    mean_map += m.T_map_base.translation() / count;
    mean_reference += m.T_reference_base.translation() / count;
  }
  double dot = 0.0;
  double cross = 0.0;
  double spread_map_m = 0.0;
  double spread_reference_m = 0.0;
  for (const MatchedPose& m : matched) {
    const Point2 a = m.T_map_base.translation() - mean_map;
    const Point2 b = m.T_reference_base.translation() - mean_reference;
    dot += a.dot(b);
    cross += a.x() * b.y() - a.y() * b.x();
    spread_map_m = std::max(spread_map_m, a.norm());
    spread_reference_m = std::max(spread_reference_m, b.norm());
  }
  // The mean of equal numbers need not be that number: offsets of rounding size count as zero.
  const bool stands =
      std::min(spread_map_m, spread_reference_m) <= 1e-9 * (1.0 + mean_map.norm() + mean_reference.norm());
  if (stands) {
    dot = cross = 0.0;
    for (const MatchedPose& m : matched) {
      const auto [sine, cosine] = sin_cos(m.T_reference_base.theta_rad - m.T_map_base.theta_rad);
      dot += cosine;
      cross += sine;
    }
  }
  const Pose2 rotation{0.0, 0.0, atan2(cross, dot)};
  const Point2 shift = mean_reference - rotation * mean_map;
  return {shift.x(), shift.y(), rotation.theta_rad};
}

/// Returns the stretch of each pose, from 0. A new stretch begins where the clock steps back. Steps of less than a
/// second do not count: recorders that stamp messages on arrival make such steps.
std::vector<std::size_t> split_stretches(const Trajectory& trajectory, double tolerance_s) {
  std::vector<std::size_t> stretches;
  stretches.reserve(trajectory.size());
  std::size_t stretch = 0;
  double last_s = -std::numeric_limits<double>::infinity();
  for (const StampedPose& pose : trajectory) {
    if (pose.stamp_s < last_s - std::max(kClockStep_s, tolerance_s)) ++stretch;
    if (std::isfinite(pose.stamp_s)) last_s = pose.stamp_s;
    stretches.push_back(stretch);
  }
  return stretches;
}

/// Number of stamps of a trajectory that occur in two stretches of another, within the tolerance.
std::size_t count_ambiguous(const Trajectory& asking, const Trajectory& asked, double tolerance_s) {
  const RepeatedStamps repeated(asked, tolerance_s);
  return static_cast<std::size_t>(std::count_if(asking.begin(), asking.end(),
                                                [&](const StampedPose& pose) { return repeated.have(pose.stamp_s); }));
}

std::vector<Trajectory> split(const Trajectory& trajectory, const std::vector<std::size_t>& stretches) {
  std::vector<Trajectory> parts(stretches.empty() ? 0 : stretches.back() + 1);
  for (std::size_t i = 0; i < trajectory.size(); ++i) parts[stretches[i]].push_back(trajectory[i]);
  return parts;
}

// At least two poses of the reference must match: if all stamps are equal, poses cannot be distinguished.
std::vector<MatchedPose> matched_by_stamp(const Trajectory& estimate, const Trajectory& reference, double tolerance_s) {
  const std::vector<std::optional<std::size_t>> indices = matches_by_stamp(estimate, reference, tolerance_s);
  std::vector<MatchedPose> matched;
  matched.reserve(estimate.size());
  std::optional<std::size_t> first;
  bool is_one = true;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const std::optional<std::size_t>& k = indices[i];
    if (!k) continue;
    if (!first) first = k;
    is_one = is_one && *k == *first;
    matched.push_back({estimate[i].stamp_s, estimate[i].T_map_base, reference[*k].T_map_base});
  }
  if (matched.size() < 2) {
    throw InputError("only " + std::to_string(matched.size()) + " of " + std::to_string(estimate.size()) +
                     " stamps of the trajectory occur in the reference; two are needed. Are both in the same clock?");
  }
  if (is_one) {
    throw InputError("the " + std::to_string(matched.size()) +
                     " poses whose stamps occur in the reference all meet one pose of it; two are needed. Do their "
                     "stamps tell them apart?");
  }
  return matched;
}

// The reference's path up to each pose.
std::vector<double> path_along(const std::vector<MatchedPose>& matched) {
  std::vector<double> path_m(matched.size(), 0.0);
  for (std::size_t k = 1; k < matched.size(); ++k) {
    const Point2 step = matched[k].T_reference_base.translation() - matched[k - 1].T_reference_base.translation();
    path_m[k] = path_m[k - 1] + step.norm();
  }
  return path_m;
}

// A path is driven in the order of its stamps, whatever the order of its rows. But if the clock stepped back, the order
// of the rows is right, and by its stamps the robot would leap to and fro: then the rows make the shorter path.
std::vector<MatchedPose> in_order_of_travel(std::vector<MatchedPose> by_rows) {
  std::vector<MatchedPose> by_stamps = by_rows;
  std::stable_sort(by_stamps.begin(), by_stamps.end(),
                   [](const MatchedPose& a, const MatchedPose& b) { return a.stamp_s < b.stamp_s; });
  constexpr double kRounding = 1e-9;  // the sum of the same steps from the other end
  const bool rows_are_right = path_along(by_rows).back() < (1.0 - kRounding) * path_along(by_stamps).back();
  return rows_are_right ? std::move(by_rows) : std::move(by_stamps);
}

// Pairs of poses that are the stated length of reference path apart, one pair per start [Sturm2012].
Errors relative_errors(const std::vector<MatchedPose>& matched, double distance_m) {
  const std::vector<double> path_m = path_along(matched);
  Errors errors;
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const auto end =
        std::lower_bound(path_m.begin() + static_cast<std::ptrdiff_t>(i), path_m.end(), path_m[i] + distance_m);
    if (end == path_m.end()) break;
    const MatchedPose& b = matched[static_cast<std::size_t>(std::distance(path_m.begin(), end))];
    const Pose2 estimated = between(matched[i].T_map_base, b.T_map_base);
    const Pose2 truth = between(matched[i].T_reference_base, b.T_reference_base);
    const Pose2 error = between(truth, estimated);
    errors.add(error.translation().norm(), std::fabs(deg_from_rad(error.theta_rad)));
  }
  return errors;
}

}  // namespace

ErrorSummary summarise(std::vector<double> errors) {
  ErrorSummary summary{.count = errors.size()};
  if (errors.empty()) return summary;
  const auto count = static_cast<double>(errors.size());
  std::sort(errors.begin(), errors.end());  // the sum must not depend on the order of the errors
  summary.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / count;
  double sq_deviation = 0.0;
  double sq_sum = 0.0;
  for (const double e : errors) {
    sq_deviation += (e - summary.mean) * (e - summary.mean);
    sq_sum += e * e;
  }
  summary.deviation = errors.size() > 1 ? std::sqrt(sq_deviation / (count - 1.0)) : 0.0;
  summary.rmse = std::sqrt(sq_sum / count);
  summary.max = errors.back();
  const std::size_t middle = errors.size() / 2;
  summary.median = errors.size() % 2 == 1 ? errors[middle] : 0.5 * (errors[middle - 1] + errors[middle]);
  return summary;
}

std::vector<std::optional<std::size_t>> matches_by_stamp(const Trajectory& estimate, const Trajectory& reference,
                                                         double tolerance_s) {
  const std::vector<std::size_t> stretches = split_stretches(estimate, tolerance_s);
  const std::vector<std::size_t> of_reference = split_stretches(reference, tolerance_s);
  // A trajectory of several drives at one time, as of a merged site, can match one whose stamps occur once.
  const std::size_t ambiguous = count_ambiguous(estimate, reference, tolerance_s);
  if (ambiguous > 0 && stretches.back() != of_reference.back()) {
    throw InputError(std::to_string(ambiguous) + " stamps occur twice, a clock stepped back: the trajectory has " +
                     std::to_string(stretches.back() + 1) + " stretches of time and the reference " +
                     std::to_string(of_reference.back() + 1) + ". Cut both where the clock stepped back");
  }
  std::vector<std::optional<std::size_t>> matches(estimate.size());
  if (ambiguous == 0) {
    const PosesByStamp index(reference);
    for (std::size_t i = 0; i < estimate.size(); ++i) matches[i] = index.find_index(estimate[i].stamp_s, tolerance_s);
    return matches;
  }
  std::vector<PosesByStamp> parts;
  std::vector<std::size_t> begins{0};
  for (const Trajectory& part : split(reference, of_reference)) {
    begins.push_back(begins.back() + part.size());
    parts.emplace_back(part);
  }
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const std::size_t part = stretches[i];
    matches[i] = parts[part].find_index(estimate[i].stamp_s, tolerance_s);
    if (matches[i]) *matches[i] += begins[part];
  }
  return matches;
}

std::vector<Relation> without_repeated_stamps(std::span<const Relation> relations, const Trajectory& trajectory,
                                              double tolerance_s) {
  const RepeatedStamps repeated(trajectory, tolerance_s);
  std::vector<Relation> clear;
  std::copy_if(relations.begin(), relations.end(), std::back_inserter(clear), [&](const Relation& relation) {
    return !repeated.have(relation.t1_s) && !repeated.have(relation.t2_s);
  });
  return clear;
}

RelationReport evaluate_relations(const Trajectory& trajectory, std::span<const Relation> relations,
                                  double tolerance_s) {
  const PosesByStamp index(trajectory);
  Errors all;
  Errors short_term;
  Errors loops;
  RelationReport report;
  double worst_m = -1.0;
  for (const Relation& relation : relations) {
    const std::optional<Pose2> first = index.find(relation.t1_s, tolerance_s);
    const std::optional<Pose2> second = index.find(relation.t2_s, tolerance_s);
    if (!first || !second) {
      ++report.unmatched;
      continue;
    }
    const Pose2 T_1_2 = between(*first, *second);
    const double error_m = (T_1_2.translation() - relation.T_1_2.translation()).norm();
    const double error_deg = yaw_error_deg(T_1_2.theta_rad, relation.T_1_2.theta_rad);
    all.add(error_m, error_deg);
    (std::fabs(relation.t2_s - relation.t1_s) <= kShortTermLimit_s ? short_term : loops).add(error_m, error_deg);
    if (error_m > worst_m) {
      worst_m = error_m;
      report.worst_t1_s = relation.t1_s;
      report.worst_t2_s = relation.t2_s;
    }
  }
  report.all = all.summary();
  report.short_term = short_term.summary();
  report.loops = loops.summary();
  return report;
}

ReferenceReport evaluate_reference(const Trajectory& estimate, const Trajectory& reference,
                                   const ReferenceOptions& options) {
  const std::vector<MatchedPose> matched = matched_by_stamp(estimate, reference, options.tolerance_s);
  ReferenceReport report;
  report.matched = matched.size();
  report.unmatched = estimate.size() - matched.size();
  report.T_reference_estimate =
      options.align ? rigid_alignment(matched) : matched.front().T_reference_base * inverse(matched.front().T_map_base);
  Errors absolute;
  for (const MatchedPose& m : matched) {
    const Pose2 aligned = report.T_reference_estimate * m.T_map_base;
    absolute.add((aligned.translation() - m.T_reference_base.translation()).norm(),
                 yaw_error_deg(aligned.theta_rad, m.T_reference_base.theta_rad));
  }
  const Errors relative = relative_errors(in_order_of_travel(matched), options.rpe_distance_m);
  report.ate_m = summarise(absolute.translation_m);
  report.ate_rotation_deg = summarise(absolute.rotation_deg);
  report.rpe_m = summarise(relative.translation_m);
  report.rpe_rotation_deg = summarise(relative.rotation_deg);
  return report;
}

RepeatedStamps::RepeatedStamps(const Trajectory& trajectory, double tolerance_s) : tolerance_s_(tolerance_s) {
  const std::vector<std::size_t> stretches = split_stretches(trajectory, tolerance_s);
  if (stretches.empty() || stretches.back() == 0) return;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (std::isfinite(trajectory[i].stamp_s)) entries_.push_back({trajectory[i].stamp_s, stretches[i]});
  }
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.stamp_s < b.stamp_s; });
  next_other_.assign(entries_.size(), entries_.size());
  for (std::size_t i = entries_.size(); i-- > 1;) {
    next_other_[i - 1] = entries_[i - 1].stretch != entries_[i].stretch ? i : next_other_[i];
  }
}

bool RepeatedStamps::have(double stamp_s) const {
  const auto first = std::lower_bound(entries_.begin(), entries_.end(), stamp_s - tolerance_s_,
                                      [](const Entry& entry, double t_s) { return entry.stamp_s < t_s; });
  if (first == entries_.end()) return false;
  const std::size_t other = next_other_[static_cast<std::size_t>(first - entries_.begin())];
  return other < entries_.size() && entries_[other].stamp_s <= stamp_s + tolerance_s_;
}

PosesByStamp::PosesByStamp(const Trajectory& trajectory) {
  entries_.reserve(trajectory.size());
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (std::isfinite(trajectory[i].stamp_s)) entries_.push_back({trajectory[i], i});
  }
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.pose.stamp_s < b.pose.stamp_s; });
}

const PosesByStamp::Entry* PosesByStamp::nearest(double stamp_s, double tolerance_s) const {
  const auto later = [](double t_s, const Entry& entry) { return t_s < entry.pose.stamp_s; };
  const auto after = std::upper_bound(entries_.begin(), entries_.end(), stamp_s, later);
  const Entry* best = after == entries_.begin() ? nullptr : &*std::prev(after);
  if (after != entries_.end() && (best == nullptr || after->pose.stamp_s - stamp_s < stamp_s - best->pose.stamp_s)) {
    best = &*std::prev(std::upper_bound(after, entries_.end(), after->pose.stamp_s, later));
  }
  if (best == nullptr || !(std::fabs(best->pose.stamp_s - stamp_s) <= tolerance_s)) return nullptr;
  return best;
}

std::optional<Pose2> PosesByStamp::find(double stamp_s, double tolerance_s) const {
  const Entry* const entry = nearest(stamp_s, tolerance_s);
  return entry == nullptr ? std::nullopt : std::optional(entry->pose.T_map_base);
}

std::optional<std::size_t> PosesByStamp::find_index(double stamp_s, double tolerance_s) const {
  const Entry* const entry = nearest(stamp_s, tolerance_s);
  return entry == nullptr ? std::nullopt : std::optional(entry->index);
}

}  // namespace gdtslam
