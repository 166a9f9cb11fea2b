// What stands in for the viewer's part of `gdtslam map` where the viewer was not built.
#include "render_cloud_picture.hpp"

namespace gdtslam {

std::optional<std::string> cloud_picture_of_run(const std::string& /*cloud_file*/, const std::string& /*log*/,
                                                const Trajectory& /*trajectory*/, const calib::SweepModel& /*model*/) {
  return std::nullopt;
}

}  // namespace gdtslam
