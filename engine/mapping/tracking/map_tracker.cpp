#include "map_tracker.hpp"

#include <span>
#include <utility>
#include <vector>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/core/elementary.hpp"
#include "engine/mapping/cost/objective.hpp"
#include "engine/mapping/map/store/field_store.hpp"
#include "engine/mapping/match/match_rules.hpp"
#include "engine/mapping/match/motion_estimate.hpp"
#include "engine/mapping/match/pose_certainty.hpp"
#include "engine/mapping/match/scan_matcher.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

// Start poses come from a search, which is about as accurate as a match.
constexpr double kStartSigma_m = 0.1;
constexpr double kStartSigma_rad = 0.03;
constexpr double kLeastKnown = 0.5;      // least share of a scan in the known map; with less the scan is useless
constexpr double kLeastExplained = 0.5;  // least fitting share of that part: the rest has changed since

Matrix3 covariance_at_start() {
  return Matrix3::diagonal(square(kStartSigma_m), square(kStartSigma_m), square(kStartSigma_rad));
}

// Takes resolution and truncation from the field; odometry is always estimated.
MapperConfig config_for(MapperConfig config, const FieldView& map) {
  config.odometry.estimate = true;
  config.map.resolution_m = map.resolution_m;
  config.map.truncation_m = map.resolution_m * static_cast<double>(map.cap) / kFieldOne;
  const std::vector<std::string> found = validate(config);
  if (found.empty()) return config;
  std::string text = found.front();
  for (std::size_t i = 1; i < found.size(); ++i) text += "; " + found[i];
  throw ConfigError(text);
}

/// Number of points and the sum of their distances, 1/256 cell.
struct DistanceSum {
  std::size_t points = 0;
  std::uint64_t sum = 0;
  void add(std::uint16_t distance) {
    ++points;
    sum += distance;
  }
  [[nodiscard]] double as_share(std::size_t all) const {
    return points == 0 ? 0.0 : static_cast<double>(points) / static_cast<double>(all);
  }
  [[nodiscard]] double mean_m(double resolution_m) const {
    return points == 0 ? 0.0 : resolution_m * static_cast<double>(sum) / (kFieldOne * static_cast<double>(points));
  }
};

KnownFit measure_known_fit(const GlobalField& map, std::span<const PointCells> points, const Pose2& T_map_base,
                           double gate_m) {
  const double r = map.geometry().resolution_m;
  const double gate = gate_m / r * kFieldOne;
  const SinCos<double> turn = sin_cos(T_map_base.theta_rad);
  DistanceSum known;
  DistanceSum explained;
  for (const PointCells& point : points) {
    const double x = r * static_cast<double>(point.x);
    const double y = r * static_cast<double>(point.y);
    const std::uint16_t distance = map.at(
        map_cell_at({turn.cos * x - turn.sin * y + T_map_base.x_m, turn.sin * x + turn.cos * y + T_map_base.y_m}, r));
    if (distance >= map.cap()) continue;
    known.add(distance);
    if (static_cast<double>(distance) <= gate) explained.add(distance);
  }
  return {.share = known.as_share(points.size()),
          .mean_distance_m = known.mean_m(r),
          .explained = explained.as_share(points.size()),
          .explained_distance_m = explained.mean_m(r)};
}

// Shared by all trackers of a map.
struct TrackedField {
  TrackedField(const MapperConfig& c, const FieldView& map, Backend& cpu)
      : config(config_for(c, map)),
        field(cpu, config.map.resolution_m, config.map.radius_cells(),
              static_cast<std::uint64_t>(config.map.max_megacells) << 20U) {
    const CellBox box{map.first_cell, map.first_cell + CellOffset{static_cast<std::int32_t>(map.width),
                                                                  static_cast<std::int32_t>(map.height)}};
    field.grow_to_hold(box);
    field.require_room({&box, 1});
    field.adopt({{map.cells, std::size_t{map.stride} * map.height}, map.stride, box});
  }

  MapperConfig config;
  GlobalField field;
};

}  // namespace

struct MapTracker::State {
  explicit State(std::shared_ptr<const TrackedField> of_map)
      : map(std::move(of_map)),
        config(map->config),
        motion(config.odometry),
        scan_points(config.scan),
        matcher(config, map->field) {}

  std::shared_ptr<const TrackedField> map;
  const MapperConfig& config;
  MotionModel motion;
  Patience patience;
  ScanPoints scan_points;
  ScanMatcher matcher;
  MotionEstimate estimate{MotionEstimate::FirstPose::kGuess};
  PoseCertainty certainty{covariance_at_start()};
  KnownFit known;

  void doubt(MatchResult& result, std::span<const PointCells> points) const;
  void weigh(const MatchResult& result, std::span<const PointCells> points);
};

// At the border of a map a scan slides into it, because points outside cost most: a match must explain the points that
// it puts into the map, and these must be enough.
void MapTracker::State::doubt(MatchResult& result, std::span<const PointCells> points) const {
  const double share = measure_known_fit(map->field, points, result.T_map_base, config.gate.final_m).share;
  if (share >= kLeastKnown && result.overlap >= kLeastExplained * share) return;
  result.accepted = false;
  result.doubt = Doubt::kLowOverlap;
  result.T_map_base = result.T_map_predicted;
}

void MapTracker::State::weigh(const MatchResult& result, std::span<const PointCells> points) {
  known = measure_known_fit(map->field, points, result.T_map_base, config.gate.final_m);
  if (result.accepted) certainty.weigh(map->field, points, result.T_map_base, config.gate.final_m);
}

MapTracker::MapTracker(const MapperConfig& config, const FieldView& map, Backend& cpu)
    : state_(std::make_unique<State>(std::make_shared<const TrackedField>(config, map, cpu))) {}
MapTracker::MapTracker(std::unique_ptr<State> state) : state_(std::move(state)) {}
MapTracker::MapTracker(MapTracker&&) noexcept = default;
MapTracker& MapTracker::operator=(MapTracker&&) noexcept = default;
MapTracker::~MapTracker() = default;

MapTracker MapTracker::another() const { return MapTracker(std::make_unique<State>(state_->map)); }

void MapTracker::start_at(const Pose2& T_map_base) {
  state_->motion = MotionModel(state_->config.odometry, T_map_base);
  state_->estimate = MotionEstimate(MotionEstimate::FirstPose::kGuess);
  state_->certainty = PoseCertainty(covariance_at_start());
}

MatchResult MapTracker::process(const LaserScan& scan, const std::optional<Pose2>& T_odom_base) {
  State& s = *state_;
  const std::vector<Point2> points_m = s.scan_points.of(scan);
  std::vector<PointCells> points = in_cells(points_m, s.config.map.resolution_m);
  thin(points, kMostMatchedPoints);
  Prediction prediction = s.estimate.predict(s.motion, T_odom_base, scan.stamp_s);
  prediction.is_hopeless = s.patience.is_over();
  const bool is_matched = points.size() >= static_cast<std::size_t>(s.config.scan.min_points);
  MatchResult result;
  if (is_matched) {
    result = s.matcher.match(points, prediction, s.config.search.when == SearchWhen::kAlways);
  } else {
    result.T_map_base = result.T_map_predicted = prediction.T_map_base;
    result.points = static_cast<std::uint32_t>(points.size());
    result.doubt = Doubt::kFewPoints;
  }
  if (result.accepted) s.doubt(result, points);
  s.estimate.take(result, is_matched, keep_scan(points_m), [&](const Pose2& pose, const Pose2& matched) {
    return fits_about_as_well(s.map->field, points, pose, matched);
  });
  if (is_matched) s.patience.take(result.accepted);
  s.certainty.carry(s.motion.pose(), prediction, {result.odometry_sigma_m, result.odometry_sigma_rad});
  s.weigh(result, points);
  s.motion.correct(result.T_map_base, result.accepted);
  result.stamp_s = scan.stamp_s;
  return result;
}

const KnownFit& MapTracker::known_fit() const { return state_->known; }

PoseCovariance MapTracker::covariance() const { return state_->certainty.in_map(state_->motion.pose().theta_rad); }

}  // namespace gdtslam
