#include "session.hpp"

#include <optional>

namespace gdtslam {

std::vector<StepDoubt> doubts_by_path(const Session& session) {
  std::vector<std::optional<Matrix3>> information(session.places.size());  // information of the step to each place
  for (const PoseRelation& relation : session.path) {
    if (relation.to != relation.from + 1) continue;
    std::optional<Matrix3>& known = information[relation.to];
    known = known ? *known + relation.information : relation.information;
  }
  std::vector<StepDoubt> doubts(session.poses.size());
  for (std::size_t place = 1; place < session.places.size(); ++place) {
    if (!information[place]) continue;
    const std::size_t steps = session.places[place] - session.places[place - 1];
    const Matrix3 of_step = 1.0 / static_cast<double>(steps) * inverse(*information[place]);
    for (std::size_t i = session.places[place - 1] + 1; i <= session.places[place]; ++i) doubts[i].step = of_step;
  }
  return doubts;
}

}  // namespace gdtslam
