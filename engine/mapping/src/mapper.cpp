#include "gdtslam/mapping/mapper.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "gdtslam/compute/kernels/distance_field.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/exhaustive.hpp"
#include "gdtslam/mapping/local_field.hpp"
#include "gdtslam/mapping/objective.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "gdtslam/mapping/simplex.hpp"

namespace gdtslam {
namespace {

const MapperConfig& checked(const MapperConfig& config) {
  const std::vector<std::string> found = validate(config);
  if (found.empty()) return config;
  std::string text = found.front();
  for (std::size_t i = 1; i < found.size(); ++i) text += "; " + found[i];
  throw ConfigError(text);
}

class StageTimer {
 public:
  explicit StageTimer(double& seconds) : seconds_(&seconds), start_(std::chrono::steady_clock::now()) {}
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer() { *seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double* seconds_;
  std::chrono::steady_clock::time_point start_;
};

double distance(const Pose2& a, const Pose2& b) { return (a.translation() - b.translation()).norm(); }
double turn(const Pose2& a, const Pose2& b) { return std::fabs(wrap_angle(a.theta_rad - b.theta_rad)); }

}  // namespace

struct Mapper::State {
  State(const MapperConfig& c, Backend& b)
      : config(checked(c)),
        backend(&b),
        field(b, config.map.resolution_m, config.map.radius_cells(), std::uint64_t(config.map.max_megacells) << 20U),
        local(b, config.map.radius_cells()),
        objective(b, field, config.match.interpolation, config.match.cost) {}

  [[nodiscard]] std::uint32_t units(double metres) const {
    return static_cast<std::uint32_t>(std::lround(metres / config.map.resolution_m * kFieldOne));
  }
  [[nodiscard]] float cells(double metres) const { return static_cast<float>(metres / config.map.resolution_m); }

  Pose2 predict(const std::optional<Pose2>& T_odom_base);
  void prepare(const Pose2& predicted);
  CellPose descend(const CellPose& start, MatchResult& result);
  CellPose search(const CellPose& centre, MatchResult& result);
  void judge(const CellPose& pose, MatchResult& result);
  bool is_keyframe(const Pose2& pose) const;
  void merge(const Pose2& pose);

  MapperConfig config;
  Backend* backend;
  GlobalField field;
  LocalField local;
  Objective objective;
  MapperStatistics statistics;

  bool started = false;
  std::optional<Pose2> last_odometry;
  Pose2 T_map_base;
  Pose2 last_keyframe;
  double step_m = 0.0;  // motion since the last scan, by odometry
  double step_rad = 0.0;

  std::vector<Point2> points_m;
  std::vector<PointCells> points;
  std::vector<PointCells> gated;
  std::vector<std::uint16_t> values;
};

Pose2 Mapper::State::predict(const std::optional<Pose2>& T_odom_base) {
  Pose2 motion;
  if (T_odom_base && last_odometry) motion = between(*last_odometry, *T_odom_base);
  if (T_odom_base) last_odometry = T_odom_base;
  step_m = motion.translation().norm();
  step_rad = std::fabs(motion.theta_rad);
  return T_map_base * motion;
}

void Mapper::State::prepare(const Pose2& predicted) {
  const double r = config.map.resolution_m;
  objective.set_anchor({static_cast<std::int32_t>(std::floor(predicted.x_m / r)),
                        static_cast<std::int32_t>(std::floor(predicted.y_m / r))});
  const double sigma_xy = (config.prior.sigma_m + config.prior.sigma_per_m * step_m) / r;
  const double sigma_theta = config.prior.sigma_rad + config.prior.sigma_per_rad * step_rad;
  const double weight = config.prior.weight * kFieldOne * static_cast<double>(points.size());
  objective.set_prior({.mean = objective.to_cells(predicted),
                       .weight_xy = static_cast<float>(weight / (sigma_xy * sigma_xy)),
                       .weight_theta = static_cast<float>(weight / (sigma_theta * sigma_theta))});
}

// Equations (8) and (4) in turn, the gate narrowing around the best pose so far.
CellPose Mapper::State::descend(const CellPose& start, MatchResult& result) {
  CellPose pose = start;
  SimplexOptions options;
  for (double gate = config.gate.wide_m;; gate *= config.gate.narrowing) {
    const bool last = gate <= config.gate.final_m * 1.0001;
    const auto limit = units(last ? config.gate.final_m : gate);
    objective.residuals(pose, points, values);
    gated.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (values[i] <= limit) gated.push_back(points[i]);
    }
    const bool enough = static_cast<double>(gated.size()) >= config.gate.min_share * static_cast<double>(points.size());
    objective.set_points(enough ? std::span<const PointCells>(gated) : std::span<const PointCells>(points));
    objective.set_cap(last ? field.cap() : field.cap());
    const SimplexResult found = minimise_simplex(objective, pose, options);
    pose = found.pose;
    result.stop = found.stop;
    options.step_cells *= 0.5F;
    options.step_rad *= 0.5F;
    if (last || !enough) break;
  }
  return pose;
}

CellPose Mapper::State::search(const CellPose& centre, MatchResult& result) {
  const SearchConfig& s = config.search;
  const SearchWindow window{.centre = centre,
                            .half_xy_cells = cells(s.half_m + s.half_per_m * step_m),
                            .half_theta_rad = static_cast<float>(std::min(s.half_rad + s.half_per_rad * step_rad, kPi)),
                            .step_cells = cells(s.step_m),
                            .step_rad = static_cast<float>(s.step_rad)};
  objective.set_points(points);
  objective.set_cap(units(config.gate.wide_m));
  const ExhaustiveResult found =
      search_window(objective, window, static_cast<std::uint32_t>(s.starts), {.step_cells = 1.0F, .step_rad = 0.01F});
  result.searched = true;
  ++statistics.searches;
  return found.pose;
}

void Mapper::State::judge(const CellPose& pose, MatchResult& result) {
  objective.set_points(points);
  objective.set_cap(units(config.gate.wide_m));
  const double count = static_cast<double>(points.size());
  result.mean_cost_m = objective.data_cost(pose) / (count * kFieldOne) * config.map.resolution_m;
  objective.residuals(pose, points, values);
  const auto limit = units(config.gate.final_m);
  const auto near = std::count_if(values.begin(), values.end(), [&](std::uint16_t v) { return v <= limit; });
  result.overlap = static_cast<double>(near) / count;
  if (result.overlap < config.doubt.min_overlap) {
    result.doubt = Doubt::kLowOverlap;
  } else if (result.mean_cost_m > config.doubt.max_mean_m) {
    result.doubt = Doubt::kHighCost;
  }
}

bool Mapper::State::is_keyframe(const Pose2& pose) const {
  return config.keyframe.every_scan || distance(pose, last_keyframe) >= config.keyframe.distance_m ||
         turn(pose, last_keyframe) >= config.keyframe.angle_rad;
}

void Mapper::State::merge(const Pose2& pose) {
  const auto margin = static_cast<std::int32_t>(config.map.radius_cells());
  const CellBox window = window_of(points_m, pose, config.map.resolution_m, margin);
  field.grow_to_hold(window);
  {
    const StageTimer timer(statistics.stages.local_field_s);
    local.compute(points_m, pose, config.map.resolution_m, window);
  }
  const StageTimer timer(statistics.stages.merge_s);
  const auto threshold = units(config.merge.threshold_m);
  local.merge_into(field, config.merge.rule, threshold,
                   static_cast<std::uint32_t>(std::lround(threshold * config.merge.kappa)));
  last_keyframe = pose;
  ++statistics.keyframes;
}

Mapper::Mapper(const MapperConfig& config, Backend& backend) : state_(std::make_unique<State>(config, backend)) {}
Mapper::~Mapper() = default;
const MapperConfig& Mapper::config() const { return state_->config; }
const MapperStatistics& Mapper::statistics() const { return state_->statistics; }
const GlobalField& Mapper::field() const { return state_->field; }

MatchResult Mapper::process(const LaserScan& scan, const std::optional<Pose2>& T_odom_base) {
  State& s = *state_;
  MatchResult result;
  result.stamp_s = scan.stamp_s;
  result.T_map_predicted = s.predict(T_odom_base);
  s.points_m = points_of(scan, {.min_m = s.config.scan.min_range_m, .max_m = s.config.scan.max_range_m});
  s.points = in_cells(s.points_m, s.config.map.resolution_m);
  result.points = static_cast<std::uint32_t>(s.points.size());
  Pose2 pose = result.T_map_predicted;
  ++s.statistics.scans;
  if (s.points.size() < static_cast<std::size_t>(s.config.scan.min_points)) {
    result.doubt = Doubt::kFewPoints;
  } else if (!s.started) {
    s.merge(pose);
    s.started = true;
    result.accepted = result.merged = true;
  } else {
    const std::uint64_t before = s.objective.evaluations();
    s.prepare(pose);
    CellPose cell_pose = s.objective.to_cells(pose);
    const bool keyframe_ahead = s.is_keyframe(pose);
    if (s.config.search.when == SearchWhen::kAlways ||
        (s.config.search.when == SearchWhen::kKeyframe && keyframe_ahead)) {
      const StageTimer timer(s.statistics.stages.search_s);
      cell_pose = s.search(cell_pose, result);
    }
    {
      const StageTimer timer(s.statistics.stages.match_s);
      cell_pose = s.descend(cell_pose, result);
      s.judge(cell_pose, result);
    }
    result.evaluations = static_cast<std::uint32_t>(s.objective.evaluations() - before);
    s.statistics.evaluations += result.evaluations;
    if (result.doubt == Doubt::kNone) {
      pose = s.objective.to_metres(cell_pose);
      result.accepted = true;
      ++s.statistics.matched;
      if (s.is_keyframe(pose)) {
        s.merge(pose);
        result.merged = true;
      }
    }
  }
  if (result.doubt != Doubt::kNone) ++s.statistics.doubtful;
  s.statistics.path_m += distance(pose, s.T_map_base);
  s.T_map_base = pose;
  result.T_map_base = pose;
  return result;
}

}  // namespace gdtslam
