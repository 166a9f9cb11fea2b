// A scan as the matcher `exhaustive` treats it, in a room that is mapped already: from the points to the pose, and into
// the map. And scans of a nodding laser as `map` turns them into cloud points: beams are queued, the kernel
// sweep_points turns them into points, and these go to a sink, while the robot drives an arc and the crank turns.
#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/core/elementary.hpp"
#include "engine/mapping/cost/objective.hpp"
#include "engine/mapping/map/local_field.hpp"
#include "engine/mapping/match/scan_matcher.hpp"
#include "engine/mapping/nodding/sweep_assembler.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/error.hpp"
#include "rows.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kBeams = 361;
constexpr std::uint32_t kWindowCells = 512;  // side of the window that a keyframe changes
constexpr std::uint64_t kMostCells = 1U << 24U;

/// 45 x 45 x 49 candidates, one cell and 0.3 degrees apart, each with all points.
MapperConfig wide_search() {
  MapperConfig config;
  config.search.step_m = config.map.resolution_m;
  config.search.half_m = 22.4 * config.map.resolution_m;
  config.search.step_rad = 0.005;
  config.search.half_rad = 24.4 * config.search.step_rad;
  config.search.max_points = static_cast<std::int32_t>(kBeams);
  return config;
}
constexpr double kCandidates = 45.0 * 45.0 * 49.0;

/// About 1.02 million candidates.
constexpr std::uint32_t kManyAlong = 101;
constexpr std::uint32_t kManyTurns = 100;
constexpr std::uint32_t kManySamples = kManyAlong * kManyAlong * kManyTurns;

/// Points that a laser in the middle of a room measures all around: four walls with niches.
std::vector<Point2> points_of_room(double half_side_m) {
  std::vector<Point2> points;
  for (std::uint32_t k = 0; k < kBeams; ++k) {
    const double bearing_rad = kTwoPi * k / kBeams;
    const auto [sine, cosine] = sin_cos(bearing_rad);
    const double reach_m = half_side_m / std::max(std::fabs(sine), std::fabs(cosine));
    const double niche = k % 97 < 12 ? 0.93 : 1.0;  // makes the four quarters differ
    points.emplace_back(niche * reach_m * cosine, niche * reach_m * sine);
  }
  return points;
}

/// The map of one scan, and a matcher that finds the scan in it.
class ScanBench {
 public:
  explicit ScanBench(Backend& backend)
      : backend_(backend),
        config_(wide_search()),
        map_(backend, config_.map.resolution_m, config_.map.radius_cells(), kMostCells),
        local_(backend, config_.map.radius_cells()),
        matcher_(config_, map_) {
    const double half_cells = 0.5 * kWindowCells - config_.map.radius_cells() - 0.5;
    const std::vector<Point2> points_m = points_of_room(half_cells * config_.map.resolution_m);
    points_ = in_cells(points_m, config_.map.resolution_m);
    keyframe_ = make_keyframe_cells(points_m, config_.map.resolution_m, config_.map.radius_cells());
    map_.grow_to_hold(keyframe_.window);
    merge();
  }

  void match() {
    const Prediction prediction{
        .T_map_base = {0.06, -0.04, 0.02}, .travelled_m = 0.0, .turned_rad = 0.0, .by_odometry = true};
    result_ = matcher_.match(points_, prediction, true);
  }
  void merge() {
    local_.prepare(keyframe_, map_);
    local_.merge_into(map_, merge_step());
  }
  /// Costs of a million candidates at every point, in the form that the matcher requests them.
  void prepare_costs() {
    candidates_ = backend_.allocate(kManySamples * sizeof(PoseCandidate));
    costs_ = backend_.allocate(kManySamples * sizeof(std::uint32_t));
    point_buffer_ = backend_.allocate(points_.size() * sizeof(PointCells));
    backend_.upload(point_buffer_, std::as_bytes(std::span(points_)));
    std::vector<PoseCandidate> candidates;
    for (std::uint32_t i = 0; i < kManySamples; ++i) {
      const std::uint32_t x = i % kManyAlong;
      const std::uint32_t y = i / kManyAlong % kManyAlong;
      const std::uint32_t turn = i / (kManyAlong * kManyAlong);
      candidates.push_back({static_cast<float>(x) - 0.5F * kManyAlong, static_cast<float>(y) - 0.5F * kManyAlong,
                            0.005F * (static_cast<float>(turn) - 0.5F * kManyTurns), 0});
    }
    backend_.upload(candidates_, std::as_bytes(std::span(candidates)));
  }
  void cost_many() {
    const PoseCost::Params params =
        pose_cost_params(map_, {0, 0}, points_.size(), map_.cap(), config_.match.interpolation, config_.match.cost);
    run<PoseCost>(backend_, params, {kManySamples, 1, 1}, map_.buffer(), point_buffer_, candidates_, costs_);
  }
  [[nodiscard]] const Buffer& costs() const { return costs_; }
  [[nodiscard]] double many_look_ups() const {
    return static_cast<double>(kManySamples) * static_cast<double>(points_.size());
  }
  /// A time is valid only if the search found the pose.
  void require_found() const {
    const Pose2& found = result_.T_map_base;
    if (result_.accepted && found.translation().norm() < 0.01 && std::fabs(found.theta_rad) < 0.005) return;
    throw Error(ExitCode::kFailed, "bench: the scan was not found where it is, so its time means nothing");
  }
  [[nodiscard]] const Buffer& map_buffer() const { return map_.buffer(); }
  [[nodiscard]] double window_cells() const {
    return static_cast<double>(keyframe_.window.width()) * keyframe_.window.height();
  }

 private:
  [[nodiscard]] MergeStep merge_step() const {
    const auto threshold = static_cast<std::uint32_t>(config_.merge.threshold_m / config_.map.resolution_m * kFieldOne);
    return {.rule = config_.merge.rule, .threshold = threshold, .lift = threshold / 2};
  }

  Backend& backend_;
  MapperConfig config_;
  GlobalField map_;
  LocalField local_;
  ScanMatcher matcher_;
  std::vector<PointCells> points_;
  KeyframeCells keyframe_;
  MatchResult result_;
  Buffer point_buffer_;
  Buffer candidates_;
  Buffer costs_;
};

/// Counts the points and keeps none.
struct CountingSink : CloudSink {
  void add(std::span<const CloudPoint> points) override { count += points.size(); }
  std::size_t count = 0;
};

constexpr std::uint32_t kSweepScans = 273;
constexpr std::size_t kSweepBeams = 961;  // the paper's scanner: -30 to 210 degrees
constexpr double kScan_s = 1.0 / 37.5;
constexpr std::size_t kTableCells = std::size_t{1} << 15U;

NoddingScanner scanner() {
  std::vector<double> table(kTableCells + 1);
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = 0.78 - 0.78 * sin_cos(kTwoPi * static_cast<double>(i) / static_cast<double>(kTableCells)).cos;
  }
  return {{.height_m = 0.4, .lever_forward_m = 0.05, .lever_up_m = 0.02}, ElevationTable(std::move(table)), 37.5, 0.5};
}

NoddingScan scan_number(std::uint32_t number) {
  NoddingScan scan;
  LaserScan& laser = scan.record.scan;
  laser.stamp_s = number * kScan_s;
  laser.bearing_step_rad = rad_from_deg(0.25);
  laser.first_bearing_rad = rad_from_deg(-120.0);
  laser.T_base_laser = {0.2, 0.0, 0.0};
  for (std::size_t beam = 0; beam < kSweepBeams; ++beam) {
    laser.ranges_m.push_back(1.0F + 0.01F * static_cast<float>((beam + 7 * number) % 900));
  }
  for (const double offset_s : {-0.5 * kScan_s, -0.2 * kScan_s, 0.3 * kScan_s, 0.5 * kScan_s}) {
    scan.knots.push_back({offset_s, phase_of_turns(0.1 * (laser.stamp_s + offset_s))});
  }
  return scan;
}

}  // namespace

void add_scans(const BenchTarget& target) {
  Backend& backend = target.backend;
  const auto bench = shared_by_rows([&backend] { return std::make_shared<ScanBench>(backend); });
  const std::string size = "361 points, 1e5 candidates";
  add_row(target, "scan", "scan", "match: " + size, [bench, &backend](benchmark::State& state) {
    // A match waits for its result.
    time_work(state, {.step = [&] { bench().match(); }, .device_ns = device_clock(backend)}, kCandidates, "candidate");
    bench().require_found();
  });
  add_row(target, "scan", "scan", "merge: 512x512 window", [bench, &backend](benchmark::State& state) {
    const Work merge = work_on(backend, bench().map_buffer(), [&] { bench().merge(); });
    time_work(state, merge, bench().window_cells(), "cell");
  });
  add_row(target, "scan", "scan", "match and merge: " + size, [bench, &backend](benchmark::State& state) {
    Work both = work_on(backend, bench().map_buffer(), [&] {
      bench().match();
      bench().merge();
    });
    both.device_ns = nullptr;  // two submissions, but the clock reports only the last
    time_work(state, both, kCandidates, "candidate");
    bench().require_found();
  });
  add_row(target, "scan", "scan", "cost: 361 points, 1e6 candidates", [bench, &backend](benchmark::State& state) {
    bench().prepare_costs();
    Work costs = work_on(backend, bench().costs(), [&] { bench().cost_many(); });
    costs.in_line = 1;  // one of them keeps a slow device busy for seconds
    time_work(state, costs, bench().many_look_ups(), "look-up");
  });
}

void add_sweeps(const BenchTarget& target) {
  const std::string variant = std::to_string(kSweepScans) + " scans of " + std::to_string(kSweepBeams) + " beams";
  add_row(target, "sweep", "assemble_sweep", variant, [&backend = target.backend](benchmark::State& state) {
    std::vector<NoddingScan> scans;
    for (std::uint32_t number = 0; number < kSweepScans; ++number) scans.push_back(scan_number(number));
    const PoseKnot poses[] = {{-0.5 * kScan_s, {}}, {0.5 * kScan_s, {0.013, 0.0, 0.01}}};
    CountingSink sink;
    SweepAssembler assembler(scanner(), {}, backend, sink);
    const auto sweep = [&] {
      for (std::uint32_t number = 0; number < kSweepScans; ++number) {
        assembler.add(scans[number], number, {3.0, -2.0, 0.01 * number}, poses);
      }
      assembler.flush();
    };
    sweep();
    if (sink.count != kSweepScans * kSweepBeams) throw Error(ExitCode::kFailed, "bench: beams of a sweep were lost");
    time_work(state, {.step = sweep}, static_cast<double>(kSweepScans * kSweepBeams), "beam");
  });
}

}  // namespace gdtslam
