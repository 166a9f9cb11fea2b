// Scans of a log that was mapped, looked for again in its merged map, in windows of growing size whose centres are off
// the pose that mapping found, by the matcher `certified` and by a plain lattice of poses. Frame: map. One thread; the
// poses depend on the log and the configuration alone, the times on the machine.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "engine/compute/kernels/host_kernels.hpp"
#include "engine/core/quantile.hpp"
#include "engine/runs/mapping/stopwatch.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "rows.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

constexpr std::uint64_t kScans = 100;  // that are looked for, evenly over the log
constexpr double kGap_m = 0.005;
constexpr double kLatticeStep_m = 0.05;
constexpr double kLatticeStep_rad = 0.017453292519943295;
// A window's centre is off the pose by up to this share of its half width.
constexpr double kOffShare = 0.8;
constexpr double kKnown_m = 0.1;
constexpr double kKnown_rad = 0.017453292519943295;
constexpr std::uint64_t kSeed = 1;

struct WindowSize {
  double half_m;
  double half_rad;  ///< pi: every heading
};
constexpr std::array<WindowSize, 3> kWindows{{{1.0, 0.3490658503988659}, {5.0, kPi}, {15.0, kPi}}};

/// A scan and where mapping had it.
struct KnownScan {
  std::vector<PointCells> points;
  Pose2 T_map_base;
};

bool is_known(const Pose2& found, const Pose2& mapped) {
  return (found.translation() - mapped.translation()).norm() <= kKnown_m &&
         std::fabs(wrap_angle(found.theta_rad - mapped.theta_rad)) <= kKnown_rad;
}

void stop_if_interrupted() {
  if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted");
}

std::uint64_t count_scans(const BenchLog& log) {
  ScanStream scans({log.file}, log.read, {});
  std::uint64_t count = 0;
  while (scans.next()) ++count;
  if (count == 0) throw InputError(FilePosition{log_name(log.file), 0}, "holds no laser scan");
  return count;
}

/// The merged map of a log, and scans of it.
class CertifiedBench {
 public:
  CertifiedBench(const BenchLog& log, Backend& backend) : isa_(backend.host_isa()), mapper_(log.mapper, backend) {
    const std::uint64_t every = std::max<std::uint64_t>(count_scans(log) / kScans, 1);
    ScanStream scans({log.file}, log.read, {});
    for (std::uint64_t index = 0; const std::optional<ScanRecord> record = scans.next(); ++index) {
      stop_if_interrupted();
      const MatchResult match = mapper_.process(record->scan, record->T_odom_base);
      if (index % every != every / 2 || scans_.size() >= kScans || !match.accepted) continue;
      std::vector<PointCells> points = in_cells(to_points(record->scan, log.mapper.scan), log.mapper.map.resolution_m);
      if (points.size() < static_cast<std::size_t>(log.mapper.scan.min_points)) continue;
      if (points.size() <= kMostCertifiedPoints) scans_.push_back({std::move(points), match.T_map_base});
    }
    if (scans_.empty()) {
      throw InputError(
          FilePosition{log_name(log.file), 0},
          fmt::format("none of its scans can be looked for: they were not matched, or have fewer than {} or "
                      "more than {} returns",
                      log.mapper.scan.min_points, kMostCertifiedPoints));
    }
    copy_.emplace(mapper_.field());
    map_.emplace(copy_->view(), isa_);
  }

  /// Whatever the iterations, scans of all parts of the log.
  [[nodiscard]] std::size_t index_at(std::uint64_t iteration) const {
    return iteration * spreading_stride(scans_.size()) % scans_.size();
  }
  [[nodiscard]] const KnownScan& scan(std::size_t index) const { return scans_[index]; }
  [[nodiscard]] FieldView field() const { return copy_->view(); }
  [[nodiscard]] CertifiedMap prepared() const { return CertifiedMap(copy_->view(), isa_); }

  [[nodiscard]] CertifiedResult search(std::size_t index, const WindowSize& size) const {
    stop_if_interrupted();
    return find_pose(*map_, scans_[index].points, window_around(index, size), {.gap_m = kGap_m});
  }

  /// The peer, the least cost of a lattice and of a descent from its best. One layer of a heading after the other, so
  /// that the costs of a layer stay in the cache.
  [[nodiscard]] std::uint32_t search_lattice(std::size_t index, const WindowSize& size) const {
    const PoseWindow window = window_around(index, size);
    const std::vector<PointCells>& points = scans_[index].points;
    const FieldView& field = map_->field();
    const double r = field.resolution_m;
    const CellIndex anchor = map_cell_at(window.centre.translation(), r);
    PoseSimplex::Params walk;
    walk.cost = {.width = field.width,
                 .height = field.height,
                 .stride = field.stride,
                 .anchor_x = anchor.x - field.first_cell.x,
                 .anchor_y = anchor.y - field.first_cell.y,
                 .point_count = static_cast<std::uint32_t>(points.size()),
                 .cap = field.cap};
    walk.step_cells = static_cast<float>(kLatticeStep_m / r);
    walk.step_rad = static_cast<float>(kLatticeStep_rad);
    const auto steps = [](double half, double step) {
      return static_cast<std::int32_t>(std::floor(half / step + 1e-9));
    };
    const std::int32_t along = steps(window.half_x_m, kLatticeStep_m);
    const std::int32_t turns = steps(window.half_theta_rad, kLatticeStep_rad);
    std::vector<PoseCandidate> layer;
    std::vector<std::uint32_t> costs;
    PoseCandidate best{};
    std::uint32_t best_cost = std::numeric_limits<std::uint32_t>::max();
    for (std::int32_t t = -turns; t <= turns; ++t) {
      stop_if_interrupted();
      layer.clear();
      for (std::int32_t y = -along; y <= along; ++y) {
        for (std::int32_t x = -along; x <= along; ++x) {
          layer.push_back({static_cast<float>((window.centre.x_m + x * kLatticeStep_m) / r - anchor.x),
                           static_cast<float>((window.centre.y_m + y * kLatticeStep_m) / r - anchor.y),
                           static_cast<float>(window.centre.theta_rad + t * kLatticeStep_rad), 0});
        }
      }
      costs.resize(layer.size());
      pose_cost_host(isa_, walk.cost, field.cells, points.data(), layer.data(),
                     static_cast<std::uint32_t>(layer.size()), costs.data());
      const auto least = std::min_element(costs.begin(), costs.end());
      if (*least >= best_cost) continue;
      best_cost = *least;
      best = layer[static_cast<std::size_t>(least - costs.begin())];
    }
    PolishedPose end{best.x, best.y, best.theta};
    pose_simplex_host(isa_, walk, field.cells, points.data(), &end, 1);
    return std::min(best_cost, end.cost);
  }

 private:
  [[nodiscard]] PoseWindow window_around(std::size_t index, const WindowSize& size) const {
    Random random = Random(kSeed).split(index);
    const auto off = [&random](double half) { return random.uniform(-kOffShare, kOffShare) * half; };
    Pose2 centre = scans_[index].T_map_base;
    centre.x_m += off(size.half_m);
    centre.y_m += off(size.half_m);
    centre.theta_rad = wrap_angle(centre.theta_rad + off(size.half_rad));
    return {.centre = centre, .half_x_m = size.half_m, .half_y_m = size.half_m, .half_theta_rad = size.half_rad};
  }

  Isa isa_;
  Mapper mapper_;
  std::vector<KnownScan> scans_;
  std::optional<FieldCopy> copy_;
  std::optional<CertifiedMap> map_;
};

/// The time of one row is the mean; the counters have the shares of all scans.
void measure_searches(benchmark::State& state, const CertifiedBench& bench, const WindowSize& size) {
  std::vector<double> times_s;
  std::vector<double> boxes;
  double proven = 0.0;
  double known = 0.0;
  static_cast<void>(bench.search(0, size));  // pages and clock speed
  std::uint64_t iteration = 0;
  for (auto _ : state) {
    const std::size_t index = bench.index_at(iteration++);
    Stopwatch watch;
    const CertifiedResult found = bench.search(index, size);
    double wall_s = 0.0;
    watch.add_to(wall_s, times_s.emplace_back(0.0));
    boxes.push_back(static_cast<double>(found.boxes));
    proven += found.certified() ? 1.0 : 0.0;
    known += is_known(found.T_map_base, bench.scan(index).T_map_base) ? 1.0 : 0.0;
  }
  const auto scans = static_cast<double>(iteration);
  state.counters["median_s"] = value_at_share(times_s, 0.5);
  state.counters["p90_s"] = value_at_share(times_s, 0.9);
  state.counters["largest_s"] = value_at_share(times_s, 1.0);
  state.counters["median_boxes"] = value_at_share(boxes, 0.5);
  state.counters["most_boxes"] = value_at_share(boxes, 1.0);
  state.counters["proven_share"] = proven / scans;
  state.counters["known_share"] = known / scans;
}

void measure_lattice(benchmark::State& state, const CertifiedBench& bench, const WindowSize& size) {
  std::vector<std::uint32_t> costs;
  for (auto _ : state) costs.push_back(bench.search_lattice(bench.index_at(costs.size()), size));
  const std::size_t checked = std::min<std::size_t>(costs.size(), kScans);
  double best = 0.0;
  for (std::size_t k = 0; k < checked; ++k) {
    const std::size_t index = bench.index_at(k);
    const double excess = static_cast<double>(costs[k]) - static_cast<double>(bench.search(index, size).cost);
    const double unit_m = bench.field().resolution_m / 256.0 / static_cast<double>(bench.scan(index).points.size());
    best += excess * unit_m <= kGap_m ? 1.0 : 0.0;
  }
  state.counters["best_share"] = best / static_cast<double>(checked);
}

}  // namespace

void add_certified(const BenchTarget& cpu, const BenchLog& log) {
  const auto bench =
      shared_by_rows([log, &backend = cpu.backend] { return std::make_shared<CertifiedBench>(log, backend); });
  add_row(cpu, "certified", "prepare", "map", [bench](benchmark::State& state) {
    const FieldView field = bench().field();
    std::uint64_t bytes = 0;
    for (auto _ : state) bytes = bench().prepared().bytes();
    state.counters["map_bytes"] =
        static_cast<double>(std::uint64_t{field.width} * field.height * sizeof(std::uint16_t));
    state.counters["prepared_bytes"] = static_cast<double>(bytes);
  });
  for (const WindowSize& size : kWindows) {
    const std::string window = fmt::format("+-{:g} m, {:.0f} deg", size.half_m, deg_from_rad(2.0 * size.half_rad));
    add_row(cpu, "certified", "search", window, [bench, size](benchmark::State& state) {
      measure_searches(state, bench(), size);
    })->Iterations(kScans);
    add_row(cpu, "certified", "lattice", window,
            [bench, size](benchmark::State& state) { measure_lattice(state, bench(), size); });
  }
}

}  // namespace gdtslam
