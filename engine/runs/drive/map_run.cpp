#include "map_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/memory/sparing.hpp"
#include "engine/core/worker_pool.hpp"
#include "engine/mapping/nodding/horizontal_scans.hpp"
#include "engine/runs/drive/space_path.hpp"
#include "engine/runs/streams/log_check.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr std::size_t kMostUncast = 256;  // scans that wait to be cast into the occupancy map

// Linkage and mount of the model, or its mount alone if the elevation itself was measured.
NoddingScanner scanner_for(const NoddingJob& job) {
  return {
      .mount = job.model.mount,
      .table = job.kind == NodKind::kTilt ? ElevationTable::identity() : calib::elevation_table(job.model),
      .mirror_rate_hz = job.model.mirror_rate_hz,
      .stamp_share = job.model.stamp_share,
  };
}

}  // namespace

OccupancyBuilder::Limits occupancy_limits(const MapperConfig& config) {
  return {.resolution_m = config.map.resolution_m,
          .min_range_m = config.scan.min_range_m,
          .max_range_m = config.scan.max_range_m,
          .max_cells = static_cast<std::uint64_t>(config.map.max_megacells) << 20U};
}

/// Additional state for a nodding laser. Points go to the cloud, if there is one, and to the check of the
/// sweeps.
struct MapRun::Nodding : CloudSink {
  Nodding(const NoddingJob& job, std::unique_ptr<CloudOutput> output, Backend& backend, MapRun& run)
      : scanner(scanner_for(job)),
        stream(run.scans_, job.kind, job.model, job.limits),
        cloud(std::move(output)),
        sampler(job.check) {
    const auto take = [&run](const NoddingPose& pose, const NoddingScan& scan) { run.take(pose, scan); };
    const MapperOptions& on_failure = run.request_.on_failure;
    NoddingConfig config = job.nodding;
    config.max_step_m = run.request_.settings.mapper.odometry.max_step_m;
    mapper.emplace(config, scanner, *run.mapper_, backend, *this, take, on_failure);
    if (config.dof == PoseFreedom::kSpace) space.emplace(scanner.mount, on_failure.scratch_folder);
  }

  void add(std::span<const CloudPoint> points) override {
    if (space) return space->add(points);
    give(points);
  }
  void give(std::span<const CloudPoint> points) {
    if (cloud) cloud->add(points);
    sampler.add(points);
  }
  NoddingOutcome finish(const MapRequest& request, std::vector<LogReader::Warning>& warnings);

  NoddingScanner scanner;
  NoddingStream stream;
  std::unique_ptr<CloudOutput> cloud;
  SweepSampler sampler;
  std::optional<SpacePath> space;  ///< with poses in space
  std::optional<NoddingMapper> mapper;
};

NoddingOutcome MapRun::Nodding::finish(const MapRequest& request, std::vector<LogReader::Warning>& warnings) {
  NoddingOutcome outcome;
  outcome.statistics = mapper->statistics();
  if (space) {
    outcome.space = space->solve(threads_meant(request.on_failure.cpu.threads),
                                 [&](double share) { request.closing("comparing strokes", share); });
    space->give([this](std::span<const CloudPoint> points) { give(points); });
  }
  outcome.check = sampler.finish();
  if (std::string doubt = outcome.check.doubt(); !doubt.empty()) {
    warnings.push_back({"sweeps that do not agree", 1, std::move(doubt)});
  }
  if (!cloud) return outcome;
  outcome.cloud = cloud->finish();
  outcome.has_cloud = true;
  if (const double asked_m = cloud->config().voxel_m; outcome.cloud.voxel_m > asked_m) {
    warnings.push_back({"cloud thinned more than asked for", 1,
                        fmt::format("its cubes filled cloud.max_megavoxels; the last ones have {:g} m, "
                                    "cloud.voxel is {:g} m",
                                    outcome.cloud.voxel_m, asked_m)});
  }
  return outcome;
}

MapRun::MapRun(const MapRequest& request, Backend& backend, ScanStream scans, const NoddingJob* nodding,
               std::unique_ptr<CloudOutput> cloud)
    : request_(request),
      scans_(std::move(scans)),
      poses_(request.on_failure.scratch_folder, ByteShelf::kFewBytes),
      match_distances_m_(request.on_failure.scratch_folder, ByteShelf::kFewBytes),
      merged_scans_(request.on_failure.scratch_folder),
      observation_points_(request.settings.mapper.scan),
      observed_(request.on_failure.scratch_folder, ByteShelf::kFewBytes),
      extent_(request.settings.mapper, request.settings.occupancy.no_return_free_m),
      has_threads_(threads_meant(request.on_failure.cpu.threads) > 1),
      first_s_(kNever),
      last_s_(-kNever) {
  if (!request_.closing) request_.closing = [](std::string_view, double) {};
  if (!request_.finishing) request_.finishing = [](std::string_view) {};
  const MapperConfig config =
      nodding != nullptr ? nodding_mapper_config(request.settings.mapper, nodding->nodding) : request.settings.mapper;
  MapperOptions options = request.on_failure;
  options.with_covariance = static_cast<bool>(request.scan_mapped);
  options.with_loops = request.with_loops;
  mapper_ = std::make_unique<Mapper>(config, backend, options);
  loops_ = mapper_->loops();
  if (loops_) scans_kept_.emplace(options.scratch_folder);
  if (request.with_map) occupancy_.emplace(request.settings.occupancy, occupancy_limits(request.settings.mapper));
  if (nodding != nullptr) nodding_ = std::make_unique<Nodding>(*nodding, std::move(cloud), backend, *this);
}

MapRun::~MapRun() = default;

const GlobalField& MapRun::field() const { return loops_ ? loops_->field() : mapper_->field(); }

void MapRun::note_stamp(double stamp_s) {
  first_s_ = std::min(first_s_, stamp_s);
  last_s_ = std::max(last_s_, stamp_s);
}

// The given pose may be better than the match, whose doubts are noted. A nodding laser's pose has its loops closed.
void MapRun::take_match(const MatchResult& result, const Pose2& T_map_base, const LaserScan& scan) {
  const bool is_final = nodding_ || !loops_;
  if (result.accepted) extent_.see(scan);
  if (result.accepted && is_final) cast(scan, T_map_base);
  if (!is_final) is_kept_.push_back(result.accepted);
  if (!is_final && is_kept_.back() && request_.with_map) scans_kept_->put(scan);
  if (result.doubt != Doubt::kNone) {
    const Pose2 off = between(result.T_map_predicted, result.T_map_base);
    outcome_.doubtful.push_back({poses_.size(), result.stamp_s, result.doubt, result.accepted, off.translation().norm(),
                                 std::fabs(off.theta_rad)});
  }
  if (result.accepted && result.evaluations > 0) match_distances_m_.put(result.mean_cost_m);
  // With loops closed, the path begins with a keyframe even if its scan was not merged.
  const bool is_first = loops_ && poses_.size() == 0;
  is_merged_.push_back(!nodding_ && (result.merged || is_first));
  if (is_merged_.back()) merged_scans_.put(scan);
  if (result.merged && is_final) push_sparingly(outcome_.keyframes, poses_.size());
  poses_.put({result.stamp_s, T_map_base});
}

// A map that becomes too large for one piece is made in tiles once all keyframes have poses. A nodding laser has no
// keyframes for tiles.
void MapRun::count_in(const Pose2& T_map_base) {
  extent_.add(T_map_base.translation());
  if (outcome_.is_in_tiles || nodding_ || extent_.is_one_piece()) return;
  if (casting_) casting_->finish();
  occupancy_.reset();
  outcome_.is_in_tiles = true;
}

void MapRun::cast(const LaserScan& scan, const Pose2& T_map_base) {
  count_in(T_map_base);
  if (!occupancy_) return;
  if (!has_threads_) {
    occupancy_->add(scan, T_map_base);
    return;
  }
  if (!casting_) casting_.emplace(true, kMostUncast);
  casting_->give([this, scan, T_map_base] { occupancy_->add(scan, T_map_base); });
}

// The CPU time of the thread is in the stage that ran meanwhile, so it is moved.
void MapRun::finish_casting() {
  if (!casting_) return;
  casting_->finish();
  double& meanwhile_s = loops_ ? outcome_.loops_cpu_s : outcome_.mapper_cpu_s;
  watch_.add_cpu_to(meanwhile_s);
  meanwhile_s -= casting_->cpu_s();
  outcome_.occupancy_cpu_s += casting_->cpu_s();
}

void MapRun::take_closed(ClosedPath path) {
  outcome_.interrupted = outcome_.interrupted || !path.is_closed;
  outcome_.keyframes = path.keyframes;
  if (path.is_closed) outcome_.closed = std::move(path);
  watch_.add_cpu_to(outcome_.loops_cpu_s);
}

void MapRun::take_keyframe_scans() {
  outcome_.keyframe_scans = read_scans(merged_scans_, is_merged_, outcome_.keyframes);
  is_merged_ = {};
}

void MapRun::take(const NoddingPose& pose, const NoddingScan& scan) {
  if (nodding_->space) nodding_->space->take(pose, scan);
  if (pose.match) {
    take_match(*pose.match, pose.T_map_base, level_scan(scan, nodding_->scanner));
  } else {
    poses_.put({pose.stamp_s, pose.T_map_base});
  }
}

void MapRun::map_nodding(const Progress& progress) {
  std::uint64_t scans = 0;
  while (!stop_()) {
    std::optional<NoddingScan> scan = next_unless_stopped(nodding_->stream, stop_);
    watch_.add_cpu_to(outcome_.read_cpu_s);
    if (!scan) break;
    note_stamp(scan->record.scan.stamp_s);
    nodding_->mapper->process(std::move(*scan));
    progress(++scans, scans_.progress());
    watch_.add_to(outcome_.mapper_s, outcome_.mapper_cpu_s);
  }
  outcome_.interrupted = stop_();
  if (scans == 0) return;
  try {
    finish_nodding();
  } catch (const InputError&) {
    if (!outcome_.interrupted) throw;
    throw Error(ExitCode::kInterrupted, "interrupted before a scan could be placed; nothing is written");
  }
}

// With loops, poses and points come only now, from the closed path.
void MapRun::finish_nodding() {
  const QueueWork mapping = mapper_->statistics().device;
  std::optional<ClosedPath> path = nodding_->mapper->finish(request_.closing, stop_);
  outcome_.adjusting = mapper_->statistics().device - mapping;
  if (!path) return watch_.add_to(outcome_.mapper_s, outcome_.mapper_cpu_s);
  take_closed(std::move(*path));
  outcome_.interrupted = outcome_.interrupted || stop_();
}

// Without a merged scan there is no map to write.
void MapRun::require_a_map() const {
  if (outcome_.statistics.keyframes > 0) return;
  const FilePosition place{log_name(request_.logs.front()), 0};
  if (outcome_.interrupted) {
    throw Error(ExitCode::kInterrupted, outcome_.trajectory.empty()
                                            ? "interrupted before the first scan; nothing is written"
                                            : "interrupted before a scan could be mapped; nothing is written");
  }
  if (!outcome_.trajectory.empty()) {
    std::string text = nothing_mappable(outcome_.trajectory.size(), request_.settings.mapper.scan);
    for (const std::string& question : scans_.questions_of_units()) text += "; " + question;
    throw InputError(place, text);
  }
  if (scans_.scans_read() > 0) {
    throw InputError(place,
                     fmt::format("--skip {} leaves none of its {} scans", request_.range.skip, scans_.scans_read()));
  }
  throw InputError(place, "holds no laser scan to map; 'gdtslam doctor' says what is in it");
}

void MapRun::finish() {
  outcome_.warnings = scans_.warnings();
  if (!broken_off_.empty())
    outcome_.warnings.push_back({std::string(warning_of_end(outcome_.broken_off)), 1, broken_off_});
  if (nodding_) {
    for (LogReader::Warning& warning : nodding_->stream.warnings()) outcome_.warnings.push_back(std::move(warning));
    for (const std::string& text : nodding_->mapper->warnings()) {
      outcome_.warnings.push_back({"no horizontal scan", 1, text});
    }
  }
  outcome_.statistics = mapper_->statistics();
  outcome_.statistics.scans += beside_.scans;
  outcome_.statistics.matched += beside_.matched;
  outcome_.statistics.doubtful += beside_.doubtful;
  outcome_.statistics.keyframes += beside_.keyframes;
  if (outcome_.closed || nodding_) outcome_.statistics.path_m = path_length_m(outcome_.trajectory);
  if (nodding_) outcome_.statistics.odometry_leaps += nodding_->mapper->statistics().odometry_leaps;
  outcome_.device_loss = mapper_->device_loss();
  require_a_map();
  if (std::string question = question_of_unit(outcome_.trajectory); !question.empty()) {
    outcome_.warnings.push_back({"scans far apart", 1, std::move(question)});
  }
  for (std::string& question : scans_.questions_of_units()) {
    outcome_.warnings.push_back({"doubtful unit", 1, std::move(question)});
  }
  finish_casting();
  if (occupancy_) outcome_.occupancy = occupancy_->build();
  watch_.add_cpu_to(outcome_.occupancy_cpu_s);
  take_keyframe_scans();
  outcome_.log_duration_s = last_s_ - first_s_;
  if (!nodding_) return;
  request_.finishing("the cloud");
  outcome_.nodding = nodding_->finish(request_, outcome_.warnings);
  take_space_path();
  watch_.add_cpu_to(outcome_.cloud_cpu_s);
}

void MapRun::take_space_path() {
  if (!outcome_.nodding->space) return;
  for (std::size_t k = 0; k < outcome_.trajectory.size(); ++k) {
    outcome_.trajectory[k].T_map_base = project(outcome_.nodding->space->T_map_base[k]);
  }
}

MapOutcome MapRun::run(const Progress& progress, const std::function<bool()>& stop) {
  stop_ = stop;
  watch_ = {};
  Stopwatch whole;
  try {
    nodding_ ? map_nodding(progress) : map_flat(progress);
    outcome_.trajectory = poses_.all();
    outcome_.match_distances_m = match_distances_m_.all();
    if (loops_ && !nodding_) close_loops();
    finish();
  } catch (...) {
    // A fault of an earlier scan is reported first.
    if (casting_) casting_->finish();
    if (loops_) loops_->finish_field();
    throw;
  }
  whole.add_to(outcome_.wall_s, outcome_.cpu_s);
  return std::move(outcome_);
}

}  // namespace gdtslam
