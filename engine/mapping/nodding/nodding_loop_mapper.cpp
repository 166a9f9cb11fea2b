#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "gdtslam/mapping/nodding_mapper.hpp"
#include "horizontal_scans.hpp"
#include "scan_placer.hpp"
#include "steady_odometry.hpp"

namespace gdtslam {
namespace {

/// A scan until it is placed.
struct Kept {
  NoddingScan scan;
  std::optional<MatchResult> match;  ///< of a horizontal one
};

double between_values(double from, double to, double share) { return from + share * (to - from); }

PoseCovariance between_covariances(const PoseCovariance& from, const PoseCovariance& to, double share) {
  return {.xx = between_values(from.xx, to.xx, share),
          .xy = between_values(from.xy, to.xy, share),
          .xt = between_values(from.xt, to.xt, share),
          .yy = between_values(from.yy, to.yy, share),
          .yt = between_values(from.yt, to.yt, share),
          .tt = between_values(from.tt, to.tt, share)};
}

// One for each of `count` scans, from those of the fixes, whose numbers ascend.
std::vector<PoseCovariance> covariances_of_all(const std::vector<PoseCovariance>& of_fixes,
                                               const std::vector<std::size_t>& fixes, std::size_t count) {
  std::vector<PoseCovariance> all;
  all.reserve(count);
  std::size_t next = 0;
  for (std::size_t k = 0; k < count; ++k) {
    while (next < fixes.size() && fixes[next] <= k) ++next;
    if (next == 0 || next == fixes.size()) {
      all.push_back(next == 0 ? of_fixes.front() : of_fixes.back());
      continue;
    }
    const double share = static_cast<double>(k - fixes[next - 1]) / static_cast<double>(fixes[next] - fixes[next - 1]);
    all.push_back(between_covariances(of_fixes[next - 1], of_fixes[next], share));
  }
  return all;
}

// What speaks of fixes speaks of scans from here on.
void number_by_scans(ClosedPath& path, const std::vector<std::size_t>& fixes) {
  for (std::size_t& keyframe : path.keyframes) keyframe = fixes[keyframe];
  for (GraphPlace& place : path.places) place.scan = fixes[place.scan];
  for (ClosedLoop& loop : path.loops) {
    loop.from = fixes[loop.from];
    loop.to = fixes[loop.to];
  }
  for (PathRelation& step : path.path) {
    step.from = fixes[step.from];
    step.to = fixes[step.to];
  }
}

}  // namespace

struct NoddingLoopMapper::State {
  State(const NoddingConfig& config, const NoddingScanner& scanner, LoopMapper& with_loops, Backend& backend,
        CloudSink& cloud, PoseSink sink, MapperOptions on_failure)
      : mapper(with_loops),
        poses(std::move(sink)),
        odometry(config.max_step_m),
        horizontal(config, scanner, valid()),
        placer(config, scanner, valid(), [this]() -> const GlobalField& { return mapper.field(); },
               {backend, cloud, [this](const NoddingPose& pose, const NoddingScan& scan) { give(pose, scan); },
                std::move(on_failure)}) {}

  [[nodiscard]] const ScanConfig& valid() const { return mapper.front_end().config().scan; }
  void give(const NoddingPose& pose, const NoddingScan& scan);
  void place_all(const std::vector<Pose2>& T_map_fixes, const LoopMapper::Progress& progress,
                 const std::function<bool()>& stop);

  LoopMapper& mapper;
  PoseSink poses;
  std::deque<Kept> kept;
  std::vector<Pose2> given;        // poses of all scans that got one
  std::vector<std::size_t> fixes;  // which of them went through the 2D system
  SteadyOdometry odometry;
  HorizontalScans horizontal;
  ScanPlacer placer;
  NoddingStatistics statistics;
  bool has_fix = false;
};

void NoddingLoopMapper::State::give(const NoddingPose& pose, const NoddingScan& scan) {
  if (pose.match) fixes.push_back(given.size());
  given.push_back(pose.T_map_base);
  poses(pose, scan);
}

// A stop that came before has been heeded: the log was cut there.
void NoddingLoopMapper::State::place_all(const std::vector<Pose2>& T_map_fixes, const LoopMapper::Progress& progress,
                                         const std::function<bool()>& stop) {
  bool may_stop = !stop();
  const auto whole = static_cast<double>(kept.size());
  std::size_t fix = 0;
  for (; !kept.empty(); kept.pop_front()) {
    if (may_stop && stop()) {
      placer.leave_points();
      may_stop = false;
    }
    Kept& next = kept.front();
    if (next.match) {
      placer.take_fix(std::move(next.scan), T_map_fixes[fix++], *next.match);
    } else {
      placer.take(std::move(next.scan));
    }
    progress("placing scans", 1.0 - static_cast<double>(kept.size() - 1) / whole);
  }
  placer.finish();
}

NoddingLoopMapper::NoddingLoopMapper(const NoddingConfig& config, const NoddingScanner& scanner, LoopMapper& mapper,
                                     Backend& backend, CloudSink& cloud, PoseSink poses, MapperOptions on_failure)
    : state_(
          std::make_unique<State>(config, scanner, mapper, backend, cloud, std::move(poses), std::move(on_failure))) {}
NoddingLoopMapper::~NoddingLoopMapper() = default;
const NoddingStatistics& NoddingLoopMapper::statistics() const {
  state_->statistics = state_->placer.statistics();
  state_->statistics.sweeps = state_->horizontal.strokes();
  state_->statistics.odometry_leaps = state_->odometry.leaps();
  return state_->statistics;
}
const std::vector<std::string>& NoddingLoopMapper::warnings() const { return state_->placer.warnings(); }

void NoddingLoopMapper::process(NoddingScan scan) {
  State& s = *state_;
  std::optional<MatchResult> match;
  scan.record.T_odom_base = s.odometry.take(scan.record.T_odom_base);
  if (std::optional<PointScan> level = s.horizontal.take(scan)) {
    s.mapper.start(std::move(*level), scan.record.T_odom_base);
    match = s.mapper.finish();
    s.has_fix = true;
  }
  s.kept.push_back({std::move(scan), match});
}

ClosedPath NoddingLoopMapper::close(const LoopMapper::Progress& progress, const std::function<bool()>& stop) {
  State& s = *state_;
  if (!s.has_fix) s.horizontal.throw_none();
  ClosedPath path = s.mapper.close(progress, stop);
  s.place_all(path.T_map_base, progress, stop);
  number_by_scans(path, s.fixes);
  if (!path.covariances.empty()) path.covariances = covariances_of_all(path.covariances, s.fixes, s.given.size());
  path.T_map_base = std::move(s.given);
  return path;
}

}  // namespace gdtslam
