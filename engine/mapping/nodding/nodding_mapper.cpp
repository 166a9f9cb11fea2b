#include "gdtslam/mapping/nodding_mapper.hpp"

#include <utility>

#include "horizontal_scans.hpp"
#include "scan_placer.hpp"
#include "steady_odometry.hpp"

namespace gdtslam {

struct NoddingMapper::State {
  State(const NoddingConfig& config, const NoddingScanner& scanner, Mapper& two_d, PlacedScans placed)
      : mapper(two_d),
        odometry(config.max_step_m),
        horizontal(config, scanner, two_d.config().scan),
        placer(
            config, scanner, two_d.config().scan, [&two_d]() -> const GlobalField& { return two_d.field(); },
            std::move(placed)) {}

  Mapper& mapper;
  SteadyOdometry odometry;
  HorizontalScans horizontal;
  ScanPlacer placer;
  NoddingStatistics statistics;
};

NoddingMapper::NoddingMapper(const NoddingConfig& config, const NoddingScanner& scanner, Mapper& mapper,
                             Backend& backend, CloudSink& cloud, PoseSink poses, MapperOptions on_failure)
    : state_(std::make_unique<State>(config, scanner, mapper,
                                     PlacedScans{backend, cloud, std::move(poses), std::move(on_failure)})) {}
NoddingMapper::~NoddingMapper() = default;
const NoddingStatistics& NoddingMapper::statistics() const {
  state_->statistics = state_->placer.statistics();
  state_->statistics.sweeps = state_->horizontal.strokes();
  state_->statistics.odometry_leaps = state_->odometry.leaps();
  return state_->statistics;
}
const std::vector<std::string>& NoddingMapper::warnings() const { return state_->placer.warnings(); }

// Figure 10: horizontal scans go through the 2D system of figure 5, which fixes the pose, and with it those of the
// scans before.
void NoddingMapper::process(NoddingScan scan) {
  scan.record.T_odom_base = state_->odometry.take(scan.record.T_odom_base);
  std::optional<PointScan> level = state_->horizontal.take(scan);
  if (!level) return state_->placer.take(std::move(scan));
  const MatchResult match = state_->mapper.process(std::move(*level), scan.record.T_odom_base);
  state_->placer.take_fix(std::move(scan), match.T_map_base, match);
}

void NoddingMapper::finish() {
  if (!state_->placer.has_fix()) state_->horizontal.throw_none();
  state_->placer.finish();
}

}  // namespace gdtslam
