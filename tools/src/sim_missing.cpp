// What stands in for the simulator's part of the command where it was not built.
#include "gdtslam/core/error.hpp"
#include "scene_errors.hpp"

namespace gdtslam {

SceneErrors scene_errors(const SceneErrorsJob& /*job*/) {
  throw UnavailableError("this build cannot read scenes; configure it with -DGDTSLAM_BUILD_SIM=ON");
}

}  // namespace gdtslam
