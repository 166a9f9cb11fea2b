#include "scan_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/mapping/graph/matrix3.hpp"

namespace gdtslam {
namespace {

constexpr double kNearEnough_m = 4.0;
// The lines of the points are kept until the scan has moved this far.
constexpr double kSearchAgain_m = 0.01;
constexpr double kSearchAgain_rad = 0.001;

constexpr double kTurnStiffness = 4.0;  // relative to that of a metre

}  // namespace

void carry_with_nearest(std::span<const Pose2> before, std::span<const Pose2> after, std::span<Pose2> poses) {
  PoseBins bins(kNearEnough_m);
  for (std::size_t k = 0; k < before.size(); ++k) bins.add(k, before[k]);
  for (Pose2& pose : poses) {
    std::optional<std::size_t> nearest;
    double nearest_m2 = square(kNearEnough_m);
    bins.visit_near(pose, [&](std::size_t k) {
      const double away_m2 = squared_distance(before[k], pose);
      if (away_m2 >= nearest_m2) return;
      nearest = k;
      nearest_m2 = away_m2;
    });
    if (nearest) pose = after[*nearest] * between(before[*nearest], pose);
  }
}

ScanAdjustment::ScanAdjustment(std::span<const LineScan> keyframes, std::span<const Pose2> poses,
                               const ScanAdjustmentOptions& options)
    : keyframes_(keyframes), poses_(poses), bins_(options.near_m), options_(options) {
  for (std::size_t i = 0; i < poses_.size(); ++i) bins_.add(i, poses_[i]);
}

bool ScanAdjustment::is_neighbour(std::size_t keyframe, const Pose2& pose, std::optional<std::size_t> last) const {
  if (!last) return std::fabs(between(poses_[keyframe], pose).theta_rad) < options_.alike_rad;
  return (keyframe > *last ? keyframe - *last : *last - keyframe) < options_.next_in_time;
}

std::vector<std::size_t> ScanAdjustment::keyframes_near(const Pose2& pose, std::optional<std::size_t> last) const {
  std::vector<std::pair<double, std::size_t>> near;
  bins_.visit_near(pose, [&](std::size_t i) {
    const double away_m = std::sqrt(squared_distance(poses_[i], pose));
    if (away_m >= options_.near_m) return;
    near.emplace_back(away_m + (is_neighbour(i, pose, last) ? 0.0 : options_.neighbour_bonus_m), i);
  });
  const std::size_t count = std::min(near.size(), options_.most_keyframes);
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  std::vector<std::size_t> keyframes;
  for (std::size_t k = 0; k < count; ++k) keyframes.push_back(near[k].second);
  return keyframes;
}

/// A scan on its way.
struct ScanAdjustment::Course {
  Pose2 start;
  Pose2 searched_at;
  bool has_lines = false;
  std::vector<std::size_t> near;  ///< keyframes
  std::size_t first_pair = 0;
};

void ScanAdjustment::lay(const MovingScan& moving, Course& course, std::span<LinePair> pairs) const {
  const Pose2 moved = between(course.searched_at, moving.pose);
  const bool is_far = translation_length(moved) > kSearchAgain_m || std::fabs(moved.theta_rad) > kSearchAgain_rad;
  const bool searches = !std::exchange(course.has_lines, true) || is_far;
  if (searches) course.searched_at = moving.pose;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    LinePair& pair = pairs[k];
    const Pose2& keyframe = poses_[course.near[k]];
    pair.fixed = course.near[k];
    pair.moving = moving.number;
    pair.found_at = between(keyframe, course.searched_at);
    pair.at = between(keyframe, moving.pose);
    pair.is_found = !searches;
  }
}

void ScanAdjustment::move(MovingScan& moving, Course& course, std::span<const LinePair> pairs) const {
  Matrix3 information;
  Tangent2 gradient{};
  for (const LinePair& pair : pairs) {
    information += pair.equations.information;
    add(gradient, pair.equations.gradient);
  }
  const double mean = 0.1 * (information(0, 0) + information(1, 1) + information(2, 2)) + 1.0;
  const double hold = options_.stiffness * mean;
  const Matrix3 stiffness = Matrix3::diagonal(hold, hold, kTurnStiffness * hold);
  add(gradient, stiffness * log_tangent(between(course.start, moving.pose)));
  const Tangent2 back = inverse(information + stiffness) * gradient;
  moving.pose = moving.pose * exp_tangent({-back[0], -back[1], -back[2]});
}

void ScanAdjustment::adjust(std::span<const LineScan> scans, std::span<MovingScan> moving, LinePairs& lines,
                            WorkerPool& workers) const {
  std::vector<Course> courses(moving.size());
  const auto each = [&](const auto& work) {
    workers.run(moving.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::size_t i = begin; i < end; ++i) work(moving[i], courses[i]);
    });
  };
  each([&](const MovingScan& scan, Course& course) {
    course.start = scan.pose;
    course.near = keyframes_near(scan.pose, scan.last);
  });
  std::size_t count = 0;
  for (Course& course : courses) course.first_pair = std::exchange(count, count + course.near.size());
  std::vector<LinePair> pairs(count);
  const auto pairs_of = [&](const Course& course) {
    return std::span(pairs).subspan(course.first_pair, course.near.size());
  };
  const LineGate gate{.most_m = options_.point_gate_m, .points = options_.points};
  for (int step = 0; step < options_.iterations; ++step) {
    each([&](const MovingScan& scan, Course& course) { lay(scan, course, pairs_of(course)); });
    lines.build(scans, gate, pairs);
    each([&](MovingScan& scan, Course& course) { move(scan, course, pairs_of(course)); });
  }
}

}  // namespace gdtslam
