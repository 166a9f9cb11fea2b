#include "run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

double thread_cpu_s() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Limits the points for the proof: takes every k-th of a larger scan, as for the other matchers.
std::vector<PointCells> points_to_match(const LaserScan& scan, const MapperConfig& config, double resolution_m) {
  std::vector<PointCells> points = in_cells(to_points(scan, config.scan), resolution_m);
  const std::size_t every = (points.size() + kMostCertifiedPoints - 1) / kMostCertifiedPoints;
  if (every < 2) return points;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); i += every) points[kept++] = points[i];
  points.resize(kept);
  return points;
}

// The scans that the map was made of; none for a map without a run. A run's map.yaml also has none, because its
// occupied cells differ from the obstacles that the run's scans were matched with.
std::vector<RunKeyframe> read_own_scans(const MapField& field) {
  const std::optional<std::string> folder = find_run_folder(field.path);
  if (field.source == MapField::Source::kOccupiedCells || !folder) return {};
  std::optional<RunKeyframes> kept = field.run ? field.run->keyframes() : RunReader(*folder).keyframes();
  if (field.run) field.run->files().expect_unchanged();
  return kept ? std::move(kept->keyframes) : std::vector<RunKeyframe>{};
}

// Calls take() with the distance of each point, at the pose, to the nearest obstacle; the cap outside of the field.
template <class Take>
void for_each_distance(const DistanceFieldView& field, std::span<const PointCells> points, const Pose2& T_map_base,
                       Take take) {
  const auto [sin, cos] = sin_cos(T_map_base.theta_rad);
  const double r = field.geometry.resolution_m;
  for (const PointCells& point : points) {
    const auto x = static_cast<double>(point.x) * r;
    const auto y = static_cast<double>(point.y) * r;
    const CellIndex cell =
        field.geometry.cell_at({cos * x - sin * y + T_map_base.x_m, sin * x + cos * y + T_map_base.y_m});
    take(field.geometry.contains(cell) ? field.at(cell) : field.cap);
  }
}

// A search that ends at once has tried no pose.
std::optional<CertifiedResult> if_any(const CertifiedResult& found) {
  return std::isfinite(found.mean_cost_m) ? std::optional(found) : std::nullopt;
}

}  // namespace

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
  if (best && is_elsewhere_open) return true;
  return best && runner_up && runner_up->stop != CertifiedStop::kNothingAllowed &&
         runner_up->bound <= best->cost + as_good;
}

Localizer::Localizer(const std::string& map, const MapperConfig& config, const LocalizeLimits& limits, Backend& backend)
    : config_(config),
      limits_(limits),
      field_(framed(read_map_field(map, config.map))),
      window_(field_.known_window()) {
  try {
    Backend* const device = backend.device().kind == "cpu" ? nullptr : &backend;
    map_.emplace(field_.view(), backend.host_isa(), CertifiedMap::kAnyWindows, device);
  } catch (const InputError& error) {
    throw InputError({field_.path, 0}, error.what());
  }
  good_fit_ = make_fit_limit(own_distances_m(), resolution_m());
  if (limits.good_fit_m) {
    good_fit_.distance_m = *limits.good_fit_m;
    good_fit_.source = FitLimit::Source::kOption;
  }
}

// Scans with little overlap with the map do not count: the map may be a part cut out of the run's.
std::vector<double> Localizer::own_distances_m() const {
  std::vector<double> own_m;
  for (const RunKeyframe& own : read_own_scans(field_)) {
    const std::vector<PointCells> points = points_to_match(own.laser, config_, resolution_m());
    if (points.empty() || known_share(points, own.T_map_base) < LocalizeLimits::kLeastKnown) continue;
    const PoseWindow pose{.centre = own.T_map_base, .half_x_m = 0.0, .half_y_m = 0.0, .half_theta_rad = 0.0};
    own_m.push_back(search(points, pose, {}).mean_cost_m);
  }
  return own_m;
}

// Moves the window to the kernels' frame, and the pose back.
CertifiedResult Localizer::search(std::span<const PointCells> points, PoseWindow window,
                                  CertifiedOptions options) const {
  const Point2& origin_m = field_.kernel_origin_m;
  const auto shift = [](Pose2& pose, const Point2& by_m) {
    pose.x_m += by_m.x();
    pose.y_m += by_m.y();
  };
  shift(window.centre, -origin_m);
  for (Pose2& start : options.starts) shift(start, -origin_m);
  for (ExcludedPoses& excluded : options.excluded) shift(excluded.around, -origin_m);
  CertifiedResult found = find_pose(*map_, points, window, options);
  shift(found.T_map_base, origin_m);
  return found;
}

CertifiedOptions Localizer::options_with(double gap_m) const {
  CertifiedOptions options;
  options.gap_m = gap_m;
  options.counts_window = false;
  if (limits_.max_seconds) options.max_seconds = *limits_.max_seconds;
  return options;
}

LocalizedScan Localizer::begun(const LaserScan& scan, std::uint64_t index, std::span<const PointCells> points) const {
  LocalizedScan found;
  found.index = index;
  found.stamp_s = scan.stamp_s;
  found.points = static_cast<std::uint32_t>(points.size());
  found.has_returns = !points.empty() && points.size() >= static_cast<std::size_t>(config_.scan.min_points);
  return found;
}

// The cost of points with that mean distance; at most 4e9, which is more than any cost.
std::uint32_t Localizer::to_units(double distance_m, std::size_t points) const {
  constexpr double kMostUnits = 4.0e9;
  const double units = distance_m / resolution_m() * kFieldOne * static_cast<double>(points);
  return static_cast<std::uint32_t>(std::min(units, kMostUnits));
}

// Points that the map does not explain have at most the truncated distance.
double Localizer::worst_of_changed_m() const {
  const double truncation_m = resolution_m() * static_cast<double>(field_.file.cap) / kFieldOne;
  const double share = LocalizeLimits::kLeastExplained;
  return share * good_fit_.distance_m + (1.0 - share) * truncation_m;
}

// Finds the best pose, or ends once it is proven that none has a mean distance of `good_m` or less. If the proof tried
// no pose, the middle of the map is tried, so that there is a pose to show.
std::optional<CertifiedResult> Localizer::look_everywhere(std::span<const PointCells> points, double good_m,
                                                          CertifiedOptions options) const {
  options.wanted_bound = to_units(good_m, points.size()) + 1;
  const CertifiedResult found = search(points, window_, options);
  if (std::isfinite(found.mean_cost_m) || found.stop != CertifiedStop::kBoundReached) return if_any(found);
  options.starts = {window_.centre};
  return if_any(search(points, window_, options));
}

// A long search is mostly for a scan of another place, which many poses fit about equally well. So it looks for two
// poses that are twice the distance of "elsewhere" apart: at least one of them is elsewhere than the best pose. A best
// pose without enough lead over the worse of the two cannot get the verdict "found", so it needs no proof. Returns the
// two poses if it looked for them.
std::vector<Pose2> Localizer::look_everywhere(std::span<const PointCells> points, LocalizedScan& found) const {
  CertifiedOptions options = options_with(limits_.gap_m);
  if (!limits_.with_runner_up) {
    found.best = look_everywhere(points, good_fit_.distance_m, options);
    return {};
  }
  const std::uint64_t without_limit = std::exchange(options.max_boxes, LocalizeLimits::kWaitingBoxes);
  found.best = look_everywhere(points, good_fit_.distance_m, options);
  if (!found.best || found.best->stop != CertifiedStop::kBoxLimit) return {};
  CertifiedOptions far = elsewhere_options(found.best->T_map_base, 2.0);
  far.max_boxes = LocalizeLimits::kWaitingBoxes;
  const CertifiedResult other = search(points, window_, far);
  options.starts = {found.best->T_map_base, other.T_map_base};
  options.max_boxes = without_limit;
  const double worse_m = std::max(found.best->mean_cost_m, other.mean_cost_m);
  const double good_m = std::min(good_fit_.distance_m, std::sqrt(good_fit_.usual_m * worse_m));
  found.best = look_everywhere(points, good_m, options);
  return options.starts;
}

// Options of a short search that excludes poses near this one.
CertifiedOptions Localizer::elsewhere_options(const Pose2& T_map_base, double times_as_far) const {
  CertifiedOptions options = options_with(LocalizeLimits::kElsewhereGaps * limits_.gap_m);
  options.max_boxes = LocalizeLimits::kRunnerUpBoxes;
  options.excluded = {
      {T_map_base, times_as_far * LocalizeLimits::kElsewhereM, times_as_far * LocalizeLimits::kElsewhereRad}};
  return options;
}

LocalizedScan Localizer::find(const LaserScan& scan, std::uint64_t index, bool with_changes) const {
  const double begin_s = thread_cpu_s();
  const std::vector<PointCells> points = points_to_match(scan, config_, resolution_m());
  LocalizedScan found = begun(scan, index, points);
  const double good_m = with_changes ? std::max(worst_of_changed_m(), good_fit_.distance_m) : good_fit_.distance_m;
  if (found.has_returns) {
    CertifiedOptions options = options_with(limits_.gap_m);
    options.max_boxes = with_changes ? LocalizeLimits::kChangedBoxes : LocalizeLimits::kWaitingBoxes;
    found.best = look_everywhere(points, good_m, options);
  }
  const bool is_poor = verdict_of(found, good_fit_.distance_m) == Verdict::kPoorFit;
  found.is_changed = with_changes && is_poor && may_be_changed(points, found.best->T_map_base);
  const double accepted_m = found.is_changed ? good_m : good_fit_.distance_m;
  if (verdict_of(found, accepted_m) == Verdict::kFound) {
    look_elsewhere(points, LocalizeLimits::kWaitingBoxes, {}, found);
  }
  found.verdict = verdict_of(found, accepted_m);
  if (found.is_changed && found.verdict != Verdict::kFound) {
    found.verdict = Verdict::kPoorFit;  // a scan that also fits elsewhere does not show a change here
    found.is_changed = false;
  }
  found.cpu_s = thread_cpu_s() - begin_s;
  return found;
}

LocalizedScan Localizer::localize(const LaserScan& scan, std::uint64_t index) const {
  const double begin_s = thread_cpu_s();
  const std::vector<PointCells> points = points_to_match(scan, config_, resolution_m());
  LocalizedScan found = begun(scan, index, points);
  std::vector<Pose2> apart;
  if (found.has_returns) apart = look_everywhere(points, found);
  if (limits_.with_runner_up && verdict_of(found, good_fit_.distance_m) == Verdict::kFound) {
    look_elsewhere(points, LocalizeLimits::kElsewhereBoxes, std::move(apart), found);
  }
  found.verdict = verdict_of(found, good_fit_.distance_m);
  found.cpu_s = thread_cpu_s() - begin_s;
  return found;
}

// How much more a pose elsewhere must cost than the best one. A scan of the mapped place usually fits as well as the
// run's own scans. A scan of another building fits some places by chance, the best hardly better than the next. So the
// best pose must be nearer to the usual fit than to the fit elsewhere: best / usual < elsewhere / best.
std::uint32_t Localizer::least_lead(const CertifiedResult& best, std::size_t points) const {
  const double lead_m = best.mean_cost_m * (best.mean_cost_m / good_fit_.usual_m - 1.0);
  return to_units(std::max(limits_.gap_m, lead_m), points);
}

// Finds a good pose elsewhere, and whether a pose there may be as good as the best. A short search finds the pose. If
// it leaves the question open, a second search answers it, which needs no proof about worse poses. A search that ends
// before it has tried a pose gives no answer.
void Localizer::look_elsewhere(std::span<const PointCells> points, std::uint64_t most_boxes, std::vector<Pose2> starts,
                               LocalizedScan& found) const {
  found.as_good = found.is_changed ? to_units(limits_.gap_m, points.size()) : least_lead(*found.best, points.size());
  const std::uint32_t as_good_as = found.best->cost + found.as_good;
  CertifiedOptions options = elsewhere_options(found.best->T_map_base, 1.0);
  options.starts = std::move(starts);
  const CertifiedResult first = search(points, window_, options);
  const bool has_pose = std::isfinite(first.mean_cost_m);
  const bool is_told = first.bound > as_good_as || (has_pose && first.cost <= as_good_as);
  found.runner_up = first.stop == CertifiedStop::kNothingAllowed ? std::optional(first) : if_any(first);
  if (first.stop == CertifiedStop::kNothingAllowed || is_told) return;
  options.gap_m = 0.0;
  options.wanted_bound = as_good_as + 1;
  options.max_boxes = most_boxes;
  if (has_pose) options.starts = {first.T_map_base};
  const CertifiedResult second = search(points, window_, options);
  found.runner_up = if_any(second);
  found.is_elsewhere_open = !found.runner_up && second.bound <= as_good_as;
}

double Localizer::known_share(std::span<const PointCells> points, const Pose2& T_map_base) const {
  const DistanceFieldView field = field_.file.view();
  std::size_t known = 0;
  for_each_distance(field, points, T_map_base,
                    [&](std::uint16_t distance) { known += distance < field.cap ? 1U : 0U; });
  return points.empty() ? 0.0 : static_cast<double>(known) / static_cast<double>(points.size());
}

bool Localizer::may_be_changed(std::span<const PointCells> points, const Pose2& T_map_base) const {
  const double gate = config_.gate.final_m / resolution_m() * kFieldOne;
  std::size_t explained = 0;
  std::uint64_t sum = 0;
  for_each_distance(field_.file.view(), points, T_map_base, [&](std::uint16_t distance) {
    if (static_cast<double>(distance) > gate) return;
    ++explained;
    sum += distance;
  });
  if (explained == 0) return false;
  return may_be_changed(static_cast<double>(explained) / static_cast<double>(points.size()),
                        resolution_m() * static_cast<double>(sum) / (kFieldOne * static_cast<double>(explained)));
}

}  // namespace gdtslam
