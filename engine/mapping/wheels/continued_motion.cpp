#include "continued_motion.hpp"

#include <algorithm>
#include <cmath>

namespace gdtslam {
namespace {

constexpr MotionNoise kLeastChange{0.01, 0.005};
constexpr std::size_t kMostChanges = 200;
constexpr std::size_t kChangesToTrust = 60;  // with fewer changes those of an unknown robot are mixed in
// Shares of the changes below a quantile, and that quantile for the length of two normal variables, and for one, in
// sigmas. A robot that turns now and then has long tails, so the larger of both counts.
struct NormalQuantile {
  double share;
  double of_two;
  double of_one;
};
constexpr NormalQuantile kOfMost{0.85, 1.948, 1.440};
constexpr NormalQuantile kOfTails{0.98, 2.797, 2.326};

double share_of_sorted(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

void insert_sorted(std::vector<double>& sorted, double value) {
  sorted.insert(std::upper_bound(sorted.begin(), sorted.end(), value), value);
}

void erase_sorted(std::vector<double>& sorted, double value) {
  sorted.erase(std::lower_bound(sorted.begin(), sorted.end(), value));
}

}  // namespace

void ContinuedMotion::take(const Pose2& T_map_base, bool is_known) {
  if (!is_known) {
    ++unknown_;
    return;
  }
  if (T_map_known_) {
    const bool is_single = unknown_ == 0;
    const double per_scan = 1.0 / static_cast<double>(unknown_ + 1);
    const Tangent2 moved = log_tangent(between(*T_map_known_, T_map_base));
    const Tangent2 velocity{per_scan * moved[0], per_scan * moved[1], per_scan * moved[2]};
    if (is_single && is_single_) {
      const double dx = velocity[0] - velocity_[0];
      const double dy = velocity[1] - velocity_[1];
      learn({std::sqrt(dx * dx + dy * dy), std::fabs(velocity[2] - velocity_[2])});
    }
    velocity_ = velocity;
    is_single_ = is_single;
  }
  T_map_known_ = T_map_base;
  unknown_ = 0;
}

void ContinuedMotion::learn(const Change& change) {
  changes_.push_back(change);
  insert_sorted(changes_m_, change.m);
  insert_sorted(changes_rad_, change.rad);
  if (changes_.size() > kMostChanges) {
    erase_sorted(changes_m_, changes_.front().m);
    erase_sorted(changes_rad_, changes_.front().rad);
    changes_.pop_front();
  }
  learnt_ = kLeastChange;
  for (const NormalQuantile& quantile : {kOfMost, kOfTails}) {
    learnt_.sigma_m = std::max(learnt_.sigma_m, share_of_sorted(changes_m_, quantile.share) / quantile.of_two);
    learnt_.sigma_rad = std::max(learnt_.sigma_rad, share_of_sorted(changes_rad_, quantile.share) / quantile.of_one);
  }
}

MotionNoise ContinuedMotion::noise() const {
  const double trust = std::min(1.0, static_cast<double>(changes_.size()) / static_cast<double>(kChangesToTrust));
  const auto scans = static_cast<double>(unknown_ + 1);
  return {scans * (trust * learnt_.sigma_m + (1.0 - trust) * kOfAnyRobot.sigma_m),
          scans * (trust * learnt_.sigma_rad + (1.0 - trust) * kOfAnyRobot.sigma_rad)};
}

}  // namespace gdtslam
