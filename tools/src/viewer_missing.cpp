// What stands in for the viewer's part of `gdtslam map` and `bench` where the viewer was not built.
#include "bench_rows.hpp"
#include "render_cloud_picture.hpp"

namespace gdtslam {

std::optional<std::string> cloud_picture_of_run(const std::string& /*cloud_file*/, const std::string& /*log*/,
                                                const Trajectory& /*trajectory*/,
                                                const calib::SweepModel* /*linkage*/) {
  return std::nullopt;
}

std::vector<BenchRow> bench_viewer(const TimingOptions& /*options*/) { return {}; }

}  // namespace gdtslam
