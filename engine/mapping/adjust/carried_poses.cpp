#include "carried_poses.hpp"

#include <cstddef>
#include <optional>

#include "engine/mapping/adjust/pose_bins.hpp"
#include "engine/mapping/graph/matrix3.hpp"

namespace gdtslam {
namespace {

constexpr double kNearEnough_m = 4.0;

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

}  // namespace gdtslam
