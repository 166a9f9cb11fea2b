#include "carried_keyframes.hpp"

#include "engine/mapping/graph/matrix3.hpp"

namespace gdtslam {

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

}  // namespace gdtslam
