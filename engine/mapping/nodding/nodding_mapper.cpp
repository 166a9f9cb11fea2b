#include "gdtslam/mapping/nodding_mapper.hpp"

#include <cstddef>
#include <deque>
#include <utility>

#include "horizontal_scans.hpp"
#include "scan_placer.hpp"

namespace gdtslam {
namespace {

/// A scan until it is placed.
struct Kept {
  NoddingScan scan;
  std::optional<MatchResult> match;  ///< match of a horizontal scan
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

// Covariances for each of `count` scans, from those of the fixes, whose numbers ascend.
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

// Replaces the numbers of fixes in a path by those of their scans.
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

struct NoddingMapper::State {
  State(const NoddingConfig& config, const NoddingScanner& scanner, Mapper& two_d, PlacedScans placed)
      : mapper(two_d),
        poses(std::move(placed.poses)),
        odometry(config.max_step_m),
        horizontal(config, scanner, two_d.config().scan),
        placer(config, scanner, two_d.config().scan, [this]() -> const GlobalField& { return field(); },
               {placed.backend, placed.cloud,
                [this](const NoddingPose& pose, const NoddingScan& scan) { give(pose, scan); },
                std::move(placed.on_failure)}) {}

  [[nodiscard]] const GlobalField& field() const {
    return mapper.loops() != nullptr ? mapper.loops()->field() : mapper.field();
  }
  void give(const NoddingPose& pose, const NoddingScan& scan);
  void place(Kept scan, const Pose2& T_map_fix);
  void place_all(const std::vector<Pose2>& T_map_fixes, const LoopClosing::Progress& progress,
                 const std::function<bool()>& stop);

  Mapper& mapper;
  PoseSink poses;
  SteadyOdometry odometry;
  HorizontalScans horizontal;
  ScanPlacer placer;
  NoddingStatistics statistics;
  bool has_fix = false;
  // With loops:
  std::deque<Kept> kept;
  std::vector<Pose2> given;        // poses of all scans that got one
  std::vector<std::size_t> fixes;  // numbers of the scans matched by the 2D system
};

void NoddingMapper::State::give(const NoddingPose& pose, const NoddingScan& scan) {
  if (mapper.loops() != nullptr) {
    if (pose.match) fixes.push_back(given.size());
    given.push_back(pose.T_map_base);
  }
  poses(pose, scan);
}

void NoddingMapper::State::place(Kept scan, const Pose2& T_map_fix) {
  if (scan.match) {
    placer.take_fix(std::move(scan.scan), T_map_fix, *scan.match);
  } else {
    placer.take(std::move(scan.scan));
  }
}

// An earlier stop has already cut the log there.
void NoddingMapper::State::place_all(const std::vector<Pose2>& T_map_fixes, const LoopClosing::Progress& progress,
                                     const std::function<bool()>& stop) {
  bool may_stop = !stop();
  const auto whole = static_cast<double>(kept.size());
  std::size_t fix = 0;
  for (; !kept.empty(); kept.pop_front()) {
    if (may_stop && stop()) {
      placer.leave_points();
      may_stop = false;
    }
    const Pose2 T_map_fix = kept.front().match ? T_map_fixes[fix++] : Pose2{};
    place(std::move(kept.front()), T_map_fix);
    progress("placing scans", 1.0 - static_cast<double>(kept.size() - 1) / whole);
  }
}

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

// Figure 10: horizontal scans go through the 2D system of figure 5, which fixes their pose, and thereby those of the
// scans before.
void NoddingMapper::process(NoddingScan scan) {
  State& s = *state_;
  scan.record.T_odom_base = s.odometry.take(scan.record.T_odom_base);
  std::optional<MatchResult> match;
  if (std::optional<PointScan> level = s.horizontal.take(scan)) {
    match = s.mapper.process(std::move(*level), scan.record.T_odom_base);
    s.has_fix = true;
  }
  if (s.mapper.loops() != nullptr) {
    s.kept.push_back({std::move(scan), match});
  } else {
    s.place({std::move(scan), match}, match ? match->T_map_base : Pose2{});
  }
}

std::optional<ClosedPath> NoddingMapper::finish(const LoopClosing::Progress& progress,
                                                const std::function<bool()>& stop) {
  State& s = *state_;
  if (!s.has_fix) s.horizontal.throw_none();
  std::optional<ClosedPath> path;
  if (s.mapper.loops() != nullptr) {
    path = s.mapper.loops()->close(progress, stop);
    s.place_all(path->T_map_base, progress, stop);
  }
  s.placer.finish();
  if (!path) return path;
  number_by_scans(*path, s.fixes);
  if (!path->covariances.empty()) path->covariances = covariances_of_all(path->covariances, s.fixes, s.given.size());
  path->T_map_base = std::move(s.given);
  return path;
}

}  // namespace gdtslam
