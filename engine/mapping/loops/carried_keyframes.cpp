#include "carried_keyframes.hpp"

#include <optional>

#include "engine/mapping/adjust/pose_bins.hpp"
#include "engine/mapping/graph/matrix3.hpp"

namespace gdtslam {
namespace {

constexpr double kNearEnough_m = 4.0;

}  // namespace

void carry_keyframes_between(std::span<const std::size_t> places, std::span<const Pose2> of_places,
                             std::span<const Pose2> shape, std::span<Pose2> poses) {
  for (std::size_t place = 0; place < of_places.size(); ++place) {
    const std::size_t from = places[place];
    const bool is_last = place + 1 == of_places.size();
    const std::size_t to = is_last ? poses.size() : places[place + 1];
    for (std::size_t i = from; i < to; ++i) poses[i] = of_places[place] * between(shape[from], shape[i]);
    if (is_last) break;
    const Pose2 end = of_places[place] * between(shape[from], shape[to]);
    const Tangent2 off = log_tangent(between(end, of_places[place + 1]));
    for (std::size_t i = from + 1; i < to; ++i) {
      const double share = static_cast<double>(i - from) / static_cast<double>(to - from);
      const Tangent2 here = adjoint_matrix(between(shape[i], shape[to])) * off;
      poses[i] = poses[i] * exp_tangent({share * here[0], share * here[1], share * here[2]});
    }
  }
}

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
