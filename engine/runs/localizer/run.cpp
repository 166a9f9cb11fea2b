#include "run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/core/elementary.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

// The file with the distances of a map: the map itself, or in its folder.
std::string field_file_of(const std::string& map) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::is_directory(map, ignored)) return (fs::path(map) / "gdt.yaml").string();
  if (!fs::is_regular_file(map, ignored)) return map;  // reading it says what is wrong
  constexpr const char* kWanted = "give the folder that 'gdtslam map -o' wrote, or its gdt.yaml";
  if (!looks_like_map(map)) throw InputError({map, 0}, std::string("is no map; ") + kWanted);
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
  if (read_text<InputError>(map, kMostBytes).find("occupied_thresh") != std::string::npos) {
    throw InputError({map, 0},
                     std::string("is an occupancy map, whose distances to obstacles are not known; ") + kWanted);
  }
  return map;
}

// The kernels count in cells of the map's grid, whose origin must lie on it.
FieldView view_of(const DistanceFieldFile& file, const std::string& path) {
  const GridGeometry& grid = file.geometry;
  const double x = grid.origin_x_m / grid.resolution_m;
  const double y = grid.origin_y_m / grid.resolution_m;
  constexpr double kFarthest = 1.0e6;
  if (!(std::fabs(x) < kFarthest && std::fabs(y) < kFarthest)) {
    throw InputError({path, 0}, "the origin lies more than a million cells from the map's; was the file edited?");
  }
  return {.cells = file.cells.data(),
          .width = static_cast<std::uint32_t>(grid.width),
          .height = static_cast<std::uint32_t>(grid.height),
          .stride = static_cast<std::uint32_t>(grid.width),
          .first_cell = {static_cast<std::int32_t>(std::lround(x)), static_cast<std::int32_t>(std::lround(y))},
          .cap = file.cap,
          .resolution_m = grid.resolution_m};
}

PoseWindow known_window(const DistanceFieldFile& file, const std::string& path) {
  CellBox known{{file.geometry.width, file.geometry.height}, {0, 0}};
  for (std::int32_t y = 0; y < file.geometry.height; ++y) {
    for (std::int32_t x = 0; x < file.geometry.width; ++x) {
      if (file.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(file.geometry.width) +
                     static_cast<std::size_t>(x)] >= file.cap) {
        continue;
      }
      known.min = {std::min(known.min.x, x), std::min(known.min.y, y)};
      known.end = {std::max(known.end.x, x + 1), std::max(known.end.y, y + 1)};
    }
  }
  if (known.empty()) throw InputError({path, 0}, "the map knows no obstacle, so no scan can be found in it");
  const double r = file.geometry.resolution_m;
  return {.centre = {file.geometry.origin_x_m + 0.5 * r * (known.min.x + known.end.x),
                     file.geometry.origin_y_m + 0.5 * r * (known.min.y + known.end.y), 0.0},
          .half_x_m = 0.5 * r * known.width(),
          .half_y_m = 0.5 * r * known.height(),
          .half_theta_rad = kPi};
}

double thread_cpu_s() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// The proof takes so many points at most: every k-th of more, as the other matchers' scans are thinned.
std::vector<PointCells> points_to_match(const LaserScan& scan, const MapperConfig& config, double resolution_m) {
  std::vector<PointCells> points = in_cells(points_of(scan, config.scan), resolution_m);
  const std::size_t every = (points.size() + kMostCertifiedPoints - 1) / kMostCertifiedPoints;
  if (every < 2) return points;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += every) points[kept++] = points[i];
  points.resize(kept);
  return points;
}

// A search that is cut short at once has tried no pose.
std::optional<CertifiedResult> if_any(const CertifiedResult& found) {
  return std::isfinite(found.mean_cost_m) ? std::optional(found) : std::nullopt;
}

}  // namespace

bool looks_like_map(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const std::string ending = fs::path(path).extension().string();
  return ending == ".yaml" || ending == ".yml" || fs::exists(fs::path(path) / "gdt.yaml", ignored);
}

std::string_view to_string(Verdict verdict) {
  static constexpr std::array<std::string_view, 4> kNames{"found", "ambiguous", "poor fit", "no pose"};
  static_assert(kNames.size() == kVerdicts.size());
  return kNames.at(static_cast<std::size_t>(verdict));
}

Verdict verdict_of(const LocalizedScan& scan, double good_fit_m) {
  if (!scan.best) return Verdict::kNoPose;
  if (scan.best->mean_cost_m > good_fit_m) return Verdict::kPoorFit;
  return scan.is_ambiguous() ? Verdict::kAmbiguous : Verdict::kFound;
}

bool LocalizedScan::is_ambiguous() const {
  return best && runner_up && runner_up->stop != CertifiedStop::kNothingAllowed &&
         runner_up->bound <= best->cost + as_good;
}

Localizer::Localizer(const std::string& map, const MapperConfig& config, const LocalizeLimits& limits, Backend& backend)
    : config_(config),
      limits_(limits),
      path_(field_file_of(map)),
      file_(read_distance_field(path_)),
      window_(known_window(file_, path_)),
      good_fit_(limits.good_fit_m ? FitLimit{*limits.good_fit_m, FitLimit::Source::kOption}
                                  : fit_limit_of(path_, file_.geometry.resolution_m)) {
  try {
    Backend* const device = backend.device().kind == "cpu" ? nullptr : &backend;
    map_.emplace(view_of(file_, path_), backend.host_isa(), CertifiedMap::kAnyWindows, device);
  } catch (const InputError& error) {
    throw InputError({path_, 0}, error.what());
  }
}

CertifiedOptions Localizer::options_with(double gap_m) const {
  CertifiedOptions options;
  options.gap_m = gap_m;
  if (limits_.max_seconds) options.max_seconds = *limits_.max_seconds;
  return options;
}

LocalizedScan Localizer::localize(const LaserScan& scan, std::uint64_t index,
                                  const std::optional<Pose2>& T_map_base_reference) const {
  const double begin_s = thread_cpu_s();
  const std::vector<PointCells> points = points_to_match(scan, config_, file_.geometry.resolution_m);
  LocalizedScan found;
  found.index = index;
  found.stamp_s = scan.stamp_s;
  found.points = static_cast<std::uint32_t>(points.size());
  found.has_returns = !points.empty() && points.size() >= static_cast<std::size_t>(config_.scan.min_points);
  if (found.has_returns) found.best = if_any(find_pose(*map_, points, window_, options_with(limits_.gap_m)));
  found.as_good = static_cast<std::uint32_t>(limits_.gap_m / file_.geometry.resolution_m * kFieldOne *
                                             static_cast<double>(points.size()));
  if (found.best && limits_.with_runner_up)
    found.runner_up = elsewhere(points, found.best->T_map_base, found.best->cost + found.as_good);
  found.verdict = verdict_of(found, good_fit_.distance_m);
  if (T_map_base_reference) found.reference = beside(points, *T_map_base_reference, found.best);
  found.cpu_s = thread_cpu_s() - begin_s;
  return found;
}

// A good pose elsewhere, and whether one there may be as good as the best: a short search finds the pose; where it
// leaves the question open a second one answers it, which needs no proof of how good the poses are that are worse.
std::optional<CertifiedResult> Localizer::elsewhere(std::span<const PointCells> points, const Pose2& T_map_best,
                                                    std::uint32_t as_good_as) const {
  CertifiedOptions options = options_with(LocalizeLimits::kElsewhereGaps * limits_.gap_m);
  options.max_boxes = LocalizeLimits::kRunnerUpBoxes;
  options.excluded = ExcludedPoses{T_map_best, LocalizeLimits::kElsewhereM, LocalizeLimits::kElsewhereRad};
  const CertifiedResult first = find_pose(*map_, points, window_, options);
  if (first.stop == CertifiedStop::kNothingAllowed) return first;
  const bool has_pose = std::isfinite(first.mean_cost_m);
  if (first.bound > as_good_as || (has_pose && first.cost <= as_good_as)) return if_any(first);
  options.gap_m = 0.0;
  options.wanted_bound = as_good_as + 1;
  options.max_boxes = LocalizeLimits::kElsewhereBoxes;
  if (has_pose) options.starts = {first.T_map_base};
  return if_any(find_pose(*map_, points, window_, options));
}

ReferencePose Localizer::beside(std::span<const PointCells> points, const Pose2& T_map_base,
                                const std::optional<CertifiedResult>& best) const {
  ReferencePose reference;
  reference.T_map_base = T_map_base;
  reference.known_share = known_share(points, T_map_base);
  reference.is_within = false;
  if (!best) return reference;
  reference.distance_m = (best->T_map_base.translation() - T_map_base.translation()).norm();
  reference.angle_rad = std::fabs(wrap_angle(best->T_map_base.theta_rad - T_map_base.theta_rad));
  reference.is_within = reference.distance_m <= limits_.within_m && reference.angle_rad <= limits_.within_rad;
  if (reference.is_within) return reference;
  const PoseWindow around{.centre = T_map_base,
                          .half_x_m = limits_.within_m,
                          .half_y_m = limits_.within_m,
                          .half_theta_rad = limits_.within_rad};
  CertifiedOptions options = options_with(LocalizeLimits::kNearbyGaps * limits_.gap_m);
  options.max_boxes = LocalizeLimits::kNearbyBoxes;
  options.starts = {T_map_base};
  reference.nearby = if_any(find_pose(*map_, points, around, options));
  return reference;
}

double Localizer::known_share(std::span<const PointCells> points, const Pose2& T_map_base) const {
  const auto [sin, cos] = sin_cos(T_map_base.theta_rad);
  const DistanceFieldView field = file_.view();
  const double r = field.geometry.resolution_m;
  std::size_t known = 0;
  for (const PointCells& point : points) {
    const auto x = static_cast<double>(point.x) * r;
    const auto y = static_cast<double>(point.y) * r;
    const CellIndex cell =
        field.geometry.cell_of({cos * x - sin * y + T_map_base.x_m, sin * x + cos * y + T_map_base.y_m});
    known += field.geometry.contains(cell) && field.at(cell) < field.cap ? 1U : 0U;
  }
  return points.empty() ? 0.0 : static_cast<double>(known) / static_cast<double>(points.size());
}

}  // namespace gdtslam
