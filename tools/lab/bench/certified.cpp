#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "engine/compute/kernels/host_kernels.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/mapping/stopwatch.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "rows.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

/// One size of window.
struct CertifiedBenchRow {
  double half_m = 0.0;
  double half_rad = 0.0;  ///< pi: every heading
  double median_s = 0.0;  ///< CPU time of a search, from the points to the proof, nothing known before
  double p90_s = 0.0;
  double most_s = 0.0;
  double median_boxes = 0.0;
  std::uint64_t most_boxes = 0;
  std::uint64_t median_evaluations = 0;
  double proven_share = 0.0;  ///< whose gap was reached
  double known_share = 0.0;   ///< that ended within 10 cm and 1 degree of the pose that mapping found
  // The peer: every pose of a lattice, then a descent from the best.
  std::uint64_t lattice_scans = 0;
  std::uint64_t lattice_poses = 0;  ///< of one window
  double lattice_median_s = 0.0;
  double lattice_best_share = 0.0;  ///< that ended within the gap of the least cost
  [[nodiscard]] double times_lattice() const { return lattice_median_s / median_s; }
};

struct CertifiedBench {
  std::uint64_t log_scans = 0;
  std::uint64_t scans = 0;  ///< that were looked for
  double median_points = 0.0;
  std::uint32_t map_width = 0;
  std::uint32_t map_height = 0;
  std::uint64_t map_bytes = 0;  ///< of the field
  double prepare_s = 0.0;       ///< CPU time, for windows of any size
  std::uint64_t prepared_bytes = 0;
  std::vector<CertifiedBenchRow> rows;
};

/// The lattice's spacing.
inline constexpr double kLatticeStep_m = 0.05;
inline constexpr double kLatticeStep_rad = 0.017453292519943295;

struct WindowSize {
  double half_m;
  double half_rad;
};
constexpr std::array<WindowSize, 3> kWindows{{{1.0, 0.3490658503988659}, {5.0, kPi}, {15.0, kPi}}};
// A window's centre is off the pose by up to this share of its half width.
constexpr double kOffShare = 0.8;
constexpr double kKnown_m = 0.1;
constexpr double kKnown_rad = 0.017453292519943295;
constexpr std::uint64_t kSeed = 1;

/// A scan and where mapping had it.
struct KnownScan {
  std::vector<PointCells> points;
  Pose2 T_map_base;
};

/// A search's end, whichever way it was found.
struct Found {
  double cpu_s = 0.0;
  std::uint32_t cost = 0;
};

std::uint64_t count_scans(const CertifiedBenchJob& job) {
  ScanStream scans({job.log}, job.read, {});
  std::uint64_t count = 0;
  while (scans.next()) ++count;
  return count;
}

double cpu_of(Stopwatch& watch) {
  double wall_s = 0.0;
  double cpu_s = 0.0;
  watch.add_to(wall_s, cpu_s);
  return cpu_s;
}

template <class T>
T at_share(std::vector<T> values, double share) {
  const auto last = static_cast<double>(values.size() - 1);
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::lround(share * last));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

void stop_if(const std::function<bool()>& stop) {
  if (stop()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is printed");
}

bool is_known(const Pose2& found, const Pose2& mapped) {
  return (found.translation() - mapped.translation()).norm() <= kKnown_m &&
         std::fabs(wrap_angle(found.theta_rad - mapped.theta_rad)) <= kKnown_rad;
}

class CertifiedBenchRun {
 public:
  CertifiedBenchRun(const CertifiedBenchJob& job, Backend& backend, const std::function<bool()>& stop)
      : job_(job), stop_(stop), isa_(backend.host_isa()), mapper_(job.mapper, backend) {}

  CertifiedBench run() {
    map_log();
    prepare();
    for (const WindowSize& size : kWindows) measure(size);
    return std::move(bench_);
  }

 private:
  void map_log() {
    const std::uint64_t count = count_scans(job_);
    if (count == 0) throw InputError(FilePosition{log_name(job_.log), 0}, "holds no laser scan");
    const std::uint64_t every = std::max<std::uint64_t>(count / job_.scans, 1);
    ScanStream scans({job_.log}, job_.read, {});
    while (const std::optional<ScanRecord> record = scans.next()) {
      stop_if(stop_);
      const MatchResult match = mapper_.process(record->scan, record->T_odom_base);
      const bool is_chosen = bench_.log_scans % every == every / 2 && scans_.size() < job_.scans;
      ++bench_.log_scans;
      if (!is_chosen || !match.accepted) continue;
      std::vector<PointCells> points =
          in_cells(points_of(record->scan, job_.mapper.scan), job_.mapper.map.resolution_m);
      if (points.size() < static_cast<std::size_t>(job_.mapper.scan.min_points)) continue;
      if (points.size() <= kMostCertifiedPoints) scans_.push_back({std::move(points), match.T_map_base});
    }
    bench_.scans = scans_.size();
    if (!scans_.empty()) return;
    throw InputError(FilePosition{log_name(job_.log), 0},
                     fmt::format("none of its {} scans can be looked for: they were not matched, or have fewer than {} "
                                 "or more than {} returns",
                                 count, job_.mapper.scan.min_points, kMostCertifiedPoints));
  }

  void prepare() {
    copy_.emplace(mapper_.field());
    const FieldView field = copy_->view();
    bench_.map_width = field.width;
    bench_.map_height = field.height;
    bench_.map_bytes = std::uint64_t{field.width} * field.height * sizeof(std::uint16_t);
    Stopwatch watch;
    map_.emplace(field, isa_);
    bench_.prepare_s = cpu_of(watch);
    bench_.prepared_bytes = map_->bytes();
    std::vector<double> points;
    for (const KnownScan& scan : scans_) points.push_back(static_cast<double>(scan.points.size()));
    bench_.median_points = at_share(std::move(points), 0.5);
  }

  PoseWindow window_around(const KnownScan& scan, const WindowSize& size, std::size_t index) const {
    Random random = Random(kSeed).split(index);
    const auto off = [&random](double half) { return random.uniform(-kOffShare, kOffShare) * half; };
    Pose2 centre = scan.T_map_base;
    centre.x_m += off(size.half_m);
    centre.y_m += off(size.half_m);
    centre.theta_rad = wrap_angle(centre.theta_rad + off(size.half_rad));
    return {.centre = centre, .half_x_m = size.half_m, .half_y_m = size.half_m, .half_theta_rad = size.half_rad};
  }

  // One layer of a heading after the other, so that the costs of a layer stay in the cache.
  Found search_lattice(const KnownScan& scan, const PoseWindow& window) const {
    const FieldView& field = map_->field();
    const double r = field.resolution_m;
    const CellIndex anchor = map_cell_of(window.centre.translation(), r);
    PoseSimplex::Params walk;
    walk.cost = {.width = field.width,
                 .height = field.height,
                 .stride = field.stride,
                 .anchor_x = anchor.x - field.first_cell.x,
                 .anchor_y = anchor.y - field.first_cell.y,
                 .point_count = static_cast<std::uint32_t>(scan.points.size()),
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
    Stopwatch watch;
    for (std::int32_t t = -turns; t <= turns; ++t) {
      stop_if(stop_);
      layer.clear();
      for (std::int32_t y = -along; y <= along; ++y) {
        for (std::int32_t x = -along; x <= along; ++x) {
          layer.push_back({static_cast<float>((window.centre.x_m + x * kLatticeStep_m) / r - anchor.x),
                           static_cast<float>((window.centre.y_m + y * kLatticeStep_m) / r - anchor.y),
                           static_cast<float>(window.centre.theta_rad + t * kLatticeStep_rad), 0});
        }
      }
      costs.resize(layer.size());
      pose_cost_host(isa_, walk.cost, field.cells, scan.points.data(), layer.data(),
                     static_cast<std::uint32_t>(layer.size()), costs.data());
      const auto least = std::min_element(costs.begin(), costs.end());
      if (*least >= best_cost) continue;
      best_cost = *least;
      best = layer[static_cast<std::size_t>(least - costs.begin())];
    }
    PolishedPose end{best.x, best.y, best.theta};
    pose_simplex_host(isa_, walk, field.cells, scan.points.data(), &end, 1);
    return {cpu_of(watch), std::min(best_cost, end.cost)};
  }

  void measure_lattice(const WindowSize& size, std::span<const CertifiedResult> found, CertifiedBenchRow& row) const {
    const auto along = static_cast<std::uint64_t>(2.0 * std::floor(size.half_m / kLatticeStep_m + 1e-9) + 1.0);
    const auto turns = static_cast<std::uint64_t>(2.0 * std::floor(size.half_rad / kLatticeStep_rad + 1e-9) + 1.0);
    row.lattice_poses = along * along * turns;
    std::vector<double> times;
    double spent_s = 0.0;
    std::uint64_t best = 0;
    // In an order that a short share of them is spread over the log, too.
    const std::size_t stride = spreading_stride(scans_.size());
    for (std::size_t k = 0; k < scans_.size() && (k == 0 || spent_s < job_.lattice_s); ++k) {
      const std::size_t index = k * stride % scans_.size();
      const Found end = search_lattice(scans_[index], window_around(scans_[index], size, index));
      spent_s += end.cpu_s;
      times.push_back(end.cpu_s);
      const double excess = static_cast<double>(end.cost) - static_cast<double>(found[index].cost);
      const double unit_m = map_->field().resolution_m / 256.0 / static_cast<double>(scans_[index].points.size());
      best += excess * unit_m <= job_.gap_m ? 1U : 0U;
    }
    row.lattice_scans = times.size();
    row.lattice_median_s = at_share(std::move(times), 0.5);
    row.lattice_best_share = static_cast<double>(best) / static_cast<double>(row.lattice_scans);
  }

  void measure(const WindowSize& size) {
    CertifiedBenchRow row;
    row.half_m = size.half_m;
    row.half_rad = size.half_rad;
    std::vector<CertifiedResult> found;
    std::vector<double> times;
    std::vector<std::uint64_t> boxes;
    std::vector<std::uint64_t> evaluations;
    std::uint64_t proven = 0;
    std::uint64_t known = 0;
    for (std::size_t index = 0; index < scans_.size(); ++index) {
      stop_if(stop_);
      const KnownScan& scan = scans_[index];
      const PoseWindow window = window_around(scan, size, index);
      if (index == 0) find_pose(*map_, scan.points, window, {.gap_m = job_.gap_m});  // pages and clock speed
      Stopwatch watch;
      found.push_back(find_pose(*map_, scan.points, window, {.gap_m = job_.gap_m}));
      times.push_back(cpu_of(watch));
      boxes.push_back(found.back().boxes);
      evaluations.push_back(found.back().evaluations);
      proven += found.back().certified() ? 1U : 0U;
      known += is_known(found.back().T_map_base, scan.T_map_base) ? 1U : 0U;
    }
    const auto count = static_cast<double>(scans_.size());
    row.median_s = at_share(times, 0.5);
    row.p90_s = at_share(times, 0.9);
    row.most_s = at_share(times, 1.0);
    row.median_boxes = static_cast<double>(at_share(boxes, 0.5));
    row.most_boxes = at_share(boxes, 1.0);
    row.median_evaluations = at_share(evaluations, 0.5);
    row.proven_share = static_cast<double>(proven) / count;
    row.known_share = static_cast<double>(known) / count;
    if (job_.lattice_s > 0.0) measure_lattice(size, found, row);
    bench_.rows.push_back(row);
  }

  const CertifiedBenchJob& job_;
  const std::function<bool()>& stop_;
  Isa isa_;
  Mapper mapper_;
  std::vector<KnownScan> scans_;
  std::optional<FieldCopy> copy_;
  std::optional<CertifiedMap> map_;
  CertifiedBench bench_;
};

std::string window_text(const CertifiedBenchRow& row) {
  return row.half_rad >= kPi ? fmt::format("+-{:g} m, 360 deg", row.half_m)
                             : fmt::format("+-{:g} m, +-{:.0f} deg", row.half_m, deg_from_rad(row.half_rad));
}

std::string lattice_text(const CertifiedBenchRow& row) {
  if (row.lattice_scans == 0) return "";
  return fmt::format(" | {:>11} {:>5} {:>10.1f} {:>7.0f} {:>5.0f} %", row.lattice_poses, row.lattice_scans,
                     1e3 * row.lattice_median_s, row.times_lattice(), 100.0 * row.lattice_best_share);
}

std::string row_text(const CertifiedBenchRow& row) {
  return fmt::format("{:<18} {:>9.2f} {:>8.2f} {:>8.2f} {:>9.0f} {:>9} {:>5.0f} % {:>5.0f} %{}\n", window_text(row),
                     1e3 * row.median_s, 1e3 * row.p90_s, 1e3 * row.most_s, row.median_boxes, row.most_boxes,
                     100.0 * row.proven_share, 100.0 * row.known_share, lattice_text(row));
}

Json lattice_json(const CertifiedBenchRow& row) {
  if (row.lattice_scans == 0) return {};
  return {{"poses", row.lattice_poses},
          {"scans", row.lattice_scans},
          {"cpu_median_s", row.lattice_median_s},
          {"times_certified", row.times_lattice()},
          {"best_share", row.lattice_best_share}};
}

Json row_json(const CertifiedBenchRow& row) {
  return {{"half_m", row.half_m},
          {"half_rad", row.half_rad},
          {"cpu_median_s", row.median_s},
          {"cpu_p90_s", row.p90_s},
          {"cpu_most_s", row.most_s},
          {"median_boxes", row.median_boxes},
          {"most_boxes", row.most_boxes},
          {"median_evaluations", row.median_evaluations},
          {"proven_share", row.proven_share},
          {"known_share", row.known_share},
          {"lattice", lattice_json(row)}};
}

std::string name_of_log(const std::string& path) { return path.substr(path.rfind('/') + 1); }

std::string as_text(const CertifiedBenchJob& job, const CertifiedBench& bench, const Backend& backend) {
  const DeviceInfo& device = backend.device();
  std::string text = fmt::format("gdtslam {}\ncpu       {}, {}, one thread\n", GDTSLAM_VERSION, device.name,
                                 to_string(backend.host_isa()));
  text += fmt::format(
      "{}: {} scans mapped, {} of them looked for in their map, {:.0f} returns, gap {:g} mm\n"
      "map: {} x {} cells, {:.1f} MB; prepared in {:.0f} ms, {:.1f} MB more\n",
      name_of_log(job.log), bench.log_scans, bench.scans, bench.median_points, 1e3 * job.gap_m, bench.map_width,
      bench.map_height, 1e-6 * static_cast<double>(bench.map_bytes), 1e3 * bench.prepare_s,
      1e-6 * static_cast<double>(bench.prepared_bytes));
  const bool has_lattice = job.lattice_s > 0.0;
  text += fmt::format("{:<18} {:>9} {:>8} {:>8} {:>9} {:>9} {:>7} {:>7}", "window", "median ms", "90 % ms", "most ms",
                      "boxes", "most", "proven", "known");
  if (has_lattice) {
    text += fmt::format(" | {:>11} {:>5} {:>10} {:>7} {:>7}", "poses", "scans", "median ms", "times", "best");
  }
  text += "\n";
  for (const CertifiedBenchRow& row : bench.rows) text += row_text(row);
  text +=
      "ms: CPU time of a search, from the points to the proof; no other matcher comes before it. boxes: bounded, "
      "median and most.\nknown: within 10 cm and 1 degree of where mapping had the scan, the window's centre being off "
      "by up to 80 % of its half width.\n";
  if (has_lattice) {
    text +=
        "Right of the bar the peer: all poses of a lattice of 5 cm and 1 degree in the same window, then a descent "
        "from the best.\ntimes: its time over that of the search; best: ended within the gap of the least cost.\n";
  }
  return text;
}

std::string json_text_of(const CertifiedBenchJob& job, const CertifiedBench& bench, const Backend& backend) {
  Json rows = Json::array();
  for (const CertifiedBenchRow& row : bench.rows) rows.push_back(row_json(row));
  const Json report{{"version", GDTSLAM_VERSION},
                    {"device", backend.device().name},
                    {"isa", to_string(backend.host_isa())},
                    {"log", name_of_log(job.log)},
                    {"log_scans", bench.log_scans},
                    {"scans", bench.scans},
                    {"median_points", bench.median_points},
                    {"gap_m", job.gap_m},
                    {"map",
                     {{"width", bench.map_width},
                      {"height", bench.map_height},
                      {"bytes", bench.map_bytes},
                      {"prepare_cpu_s", bench.prepare_s},
                      {"prepared_bytes", bench.prepared_bytes}}},
                    {"lattice_step_m", kLatticeStep_m},
                    {"lattice_step_rad", kLatticeStep_rad},
                    {"windows", rows}};
  return json_text(report);
}

}  // namespace

std::string bench_certified(const CertifiedBenchJob& job, Backend& backend, const std::function<bool()>& stop,
                            bool is_json) {
  const CertifiedBench bench = CertifiedBenchRun(job, backend, stop).run();
  return is_json ? json_text_of(job, bench, backend) : as_text(job, bench, backend);
}

}  // namespace gdtslam
