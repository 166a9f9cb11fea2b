#include "gdtslam/mapping/loop_closing.hpp"

#include <cmath>
#include <exception>
#include <optional>

#include "engine/core/side_thread.hpp"
#include "engine/core/worker_pool.hpp"
#include "engine/mapping/back_end/back_end.hpp"
#include "engine/mapping/map/keyframe_map.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {
namespace {

constexpr double kStretch_m = 15.0;  // path length of a local map if the configuration sets none

PoseInformation pose_information(const Matrix3& m) {
  return {.xx = m(0, 0), .xy = m(0, 1), .xt = m(0, 2), .yy = m(1, 1), .yt = m(1, 2), .tt = m(2, 2)};
}

std::size_t scan_of_place(const BackEndResult& result, std::size_t place) {
  return result.keyframes[result.places[place]];
}

ClosedLoop closed_loop(const Loop& loop, const BackEndResult& result) {
  const PoseRelation& relation = loop.relation;
  const Tangent2 off = relation_residual(relation, result.graph.poses[relation.from], result.graph.poses[relation.to]);
  return {.from = scan_of_place(result, relation.from),
          .to = scan_of_place(result, relation.to),
          .T_from_to = relation.T_from_to,
          .information = pose_information(relation.information),
          .weight = loop.weight,
          .off_m = std::sqrt(off[0] * off[0] + off[1] * off[1]),
          .off_rad = std::fabs(off[2]),
          .is_on = loop.is_on()};
}

std::vector<GraphPlace> graph_places(const BackEndResult& result) {
  std::vector<GraphPlace> places;
  places.reserve(result.places.size());
  for (std::size_t i = 0; i < result.places.size(); ++i) {
    places.push_back({scan_of_place(result, i), result.graph.poses[i]});
  }
  return places;
}

std::vector<PathRelation> path_relations(const BackEndResult& result) {
  std::vector<PathRelation> relations;
  relations.reserve(result.graph.path.size() + result.graph.wheels.size());
  const auto add = [&](const PoseRelation& relation, bool is_by_wheels) {
    relations.push_back({.from = scan_of_place(result, relation.from),
                         .to = scan_of_place(result, relation.to),
                         .T_from_to = relation.T_from_to,
                         .information = pose_information(relation.information),
                         .is_by_wheels = is_by_wheels});
  };
  for (const PoseRelation& relation : result.graph.path) add(relation, false);
  for (const WheelRelation& step : result.graph.wheels) add(step.relation, true);
  return relations;
}

WheelReport wheel_report(const BackEndResult& result) {
  const WheelBias& bias = result.wheels;
  const auto factor = [&](StepSource source) { return result.factors[static_cast<std::size_t>(source)].variance; };
  return {.distance = bias.distance,
          .turn = bias.turn,
          .turn_rad_per_m = bias.turn_rad_per_m,
          .sigma_distance = bias.sigma_distance,
          .sigma_turn = bias.sigma_turn,
          .sigma_rad_per_m = bias.sigma_rad_per_m,
          .variance_factor = factor(StepSource::kWheels),
          .variance_factor_of_matches = factor(StepSource::kFrontEnd)};
}

PoseCovariance pose_covariance(const Matrix3& c) {
  return {.xx = c(0, 0), .xy = c(0, 1), .xt = c(0, 2), .yy = c(1, 1), .yt = c(1, 2), .tt = c(2, 2)};
}

struct Stopped {};  // thrown through the back end by its own progress

}  // namespace

struct LoopClosing::State {
  State(const MapperConfig& c, const MapperOptions& options, const BatchDevice& device)
      : config(c),
        threads(threads_meant(options.cpu.threads)),
        back_end({.loops = {},
                  .live = {.is_beside = options.loops_beside,
                           .warn = options.warn,
                           .threads = threads,
                           .scratch_folder = options.scratch_folder},
                  .joint = {},
                  .scans = {},
                  .device = device,
                  .threads = threads,
                  .scratch_folder = options.scratch_folder}),
        map(config) {}

  BackEndResult closed(const Progress& progress, const std::function<bool()>& stop);
  void rebuild(const std::vector<std::size_t>& keyframes, const std::vector<Pose2>& poses);

  MapperConfig config;
  unsigned threads;
  BackEnd back_end;
  SeparateMap map;                    // map of all keyframes at their final poses
  std::exception_ptr too_large;       // error if it cannot hold them
  std::optional<SideThread> mapping;  // thread that makes it
};

LoopClosing::LoopClosing(const MapperConfig& config, const MapperOptions& options, const BatchDevice& device)
    : state_(std::make_unique<State>(config, options, device)) {}
LoopClosing::~LoopClosing() = default;

MapperConfig LoopClosing::adapt_config(MapperConfig config) {
  if (config.local.stretch_m == 0.0) config.local.stretch_m = kStretch_m;
  config.odometry.estimate = true;
  return config;
}

void LoopClosing::take(const KeptScan& scan, const MatchResult& result) { state_->back_end.take(scan, result); }

double LoopClosing::finish_field() const {
  if (!state_->mapping) return 0.0;
  state_->mapping->finish();
  return state_->mapping->cpu_s();
}

const GlobalField& LoopClosing::field() const {
  finish_field();
  if (state_->too_large) std::rethrow_exception(state_->too_large);
  return state_->map.field();
}

const Pose2& LoopClosing::correction() const { return state_->back_end.loops().correction(); }
LiveStatistics LoopClosing::statistics() const { return state_->back_end.loops().statistics(); }
std::shared_future<FrozenMap> LoopClosing::request_map() {
  return state_->back_end.loops().request_map(state_->config);
}

std::shared_future<ClosedKeyframes> LoopClosing::request_keyframes() {
  return state_->back_end.loops().request_keyframes();
}

// Equations (1) and (9) to (11), in the order in which the keyframes were taken.
void LoopClosing::State::rebuild(const std::vector<std::size_t>& keyframes, const std::vector<Pose2>& poses) {
  try {
    back_end.visit_keyframes(
        [&](std::size_t i, const KeptScan& scan) { map.merge(to_points(scan), poses[keyframes[i]]); });
  } catch (const InputError&) {
    too_large = std::current_exception();
  }
}

BackEndResult LoopClosing::State::closed(const Progress& progress, const std::function<bool()>& stop) {
  try {
    return back_end.finish([&](std::string_view step, double share) {
      if (stop()) throw Stopped{};
      progress(step, share);
    });
  } catch (const Stopped&) {
    return back_end.as_driven();
  }
}

ClosedPath LoopClosing::close(const Progress& progress, const std::function<bool()>& stop) {
  const BackEndResult result = stop() ? state_->back_end.as_driven() : state_->closed(progress, stop);
  state_->mapping.emplace(state_->threads > 1, 1);
  state_->mapping->give(
      [state = state_.get(), keyframes = result.keyframes, poses = result.poses] { state->rebuild(keyframes, poses); });
  ClosedPath path{.is_closed = result.is_closed,
                  .T_map_base = result.poses,
                  .covariances = {},
                  .wheels = wheel_report(result),
                  .keyframes = result.keyframes,
                  .loops = {},
                  .places = graph_places(result),
                  .path = path_relations(result),
                  .searches = result.counts.searched,
                  .pruned = result.keyframes.size() - state_->back_end.kept().size(),
                  .pairs = result.joint.pairs,
                  .rms_m = result.joint.rms_m};
  path.covariances.reserve(result.covariances.size());
  path.loops.reserve(result.graph.loops.size());
  for (const Matrix3& covariance : result.covariances) path.covariances.push_back(pose_covariance(covariance));
  for (const Loop& loop : result.graph.loops) path.loops.push_back(closed_loop(loop, result));
  return path;
}

}  // namespace gdtslam
