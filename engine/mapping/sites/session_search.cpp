#include "session_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <string>
#include <utility>

#include "engine/mapping/adjust/pose_bins.hpp"
#include "engine/mapping/loops/scan_group.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {
namespace {

constexpr double kSessionSpacing_m = 0.05;  // spacing of the points of a session that others are searched in
constexpr double kPlaceSpacing_m = 0.1;     // spacing of the points of a place in the query
constexpr double kPlaceHeld_m = 0.03;       // spacing of the points of the place it is compared with
constexpr double kSamePlace_m = 1.0;        // length of path
constexpr double kWallSpacing_m = 0.5;
constexpr double kStep_m = 0.025;          // step along a path that is tested for walls
constexpr std::uint16_t kWallUnits = 128;  // half a cell
constexpr double kDroveThere_m = 1.5;      // distance between two robots that see the same
constexpr double kFitsAtAll = 1.25;    // factor of the largest mean distance in tests of a pose: much may have changed
constexpr double kBesideHalf_m = 0.5;  // half of the window around a tested pose: drift of both
constexpr double kBesideHalf_rad = 0.05;
constexpr double kBeside_m[] = {-3.0, -1.5, 1.5, 3.0};  // offsets along the path
constexpr double kOtherPlace_m = 4.0;                   // distance between places
constexpr std::size_t kMostOthers = 4;
constexpr std::size_t kQueriesApart = 4;  // one query in this many is searched before the others in between

KeyframePath keyframe_path(const Session& session) {
  return {session.scans, session.poses, session.path_m, session.doubts};
}

std::vector<Point2> to_points(const Session& session, double spacing_m) {
  PointThinner thinner(spacing_m);
  std::vector<Point2> points;
  for (std::size_t i = 0; i < session.scans.size(); ++i) {
    for (const Point2& point : to_points(session.scans[i])) {
      const Point2 there = session.poses[i] * point;
      if (thinner.is_first(there)) points.push_back(there);
    }
  }
  return points;
}

// Distances to all walls are kept in one piece, whose sides the transforms limit.
std::vector<Point2> bounded(std::vector<Point2> points, double resolution_m) {
  constexpr double kMostCells = 32000.0;
  Point2 low = points.empty() ? Point2::Zero() : points.front();
  Point2 high = low;
  for (const Point2& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const double side_m = (high - low).maxCoeff();
  if (side_m <= kMostCells * resolution_m) return points;
  throw InputError("the site is " + std::to_string(static_cast<int>(std::min(side_m, 1.0e9))) +
                   " m wide, and in more than " + std::to_string(static_cast<int>(kMostCells * resolution_m)) +
                   " m no drive is looked for: merge those of one part of it, as runs or as pieces that 'gdtslam edit "
                   "--crop' cuts out");
}

// Window around all of the path, in every heading: the robot may have been anywhere in it.
PoseWindow window_around(const std::vector<Pose2>& poses, double beyond_m) {
  double left = poses.front().x_m;
  double right = left;
  double bottom = poses.front().y_m;
  double top = bottom;
  for (const Pose2& pose : poses) {
    left = std::min(left, pose.x_m);
    right = std::max(right, pose.x_m);
    bottom = std::min(bottom, pose.y_m);
    top = std::max(top, pose.y_m);
  }
  return {.centre = {0.5 * (left + right), 0.5 * (bottom + top), 0.0},
          .half_x_m = 0.5 * (right - left) + beyond_m,
          .half_y_m = 0.5 * (top - bottom) + beyond_m,
          .half_theta_rad = std::numbers::pi};
}

}  // namespace

struct SessionMap::State {
  State(const Session& session, const SessionSearchOptions& options)
      : backend(make_cpu_backend({})),
        field(make_distance_field(bounded(to_points(session, kSessionSpacing_m), options.resolution_m),
                                  options.resolution_m, *backend, mutex)),
        map(field.view(), best_isa()),
        window(window_around(session.poses, options.beyond_m)) {}

  std::unique_ptr<Backend> backend;
  std::mutex mutex;
  FieldCopy field;
  CertifiedMap map;
  PoseWindow window;
};

SessionMap::SessionMap(const Session& session, const SessionSearchOptions& options)
    : session_(session), options_(options), state_(std::make_unique<State>(session, options)) {}
SessionMap::~SessionMap() = default;

SessionFix SessionMap::find(const Session& query, std::size_t keyframe) const {
  SessionFix fix;
  fix.keyframe = keyframe;
  const ScanGroup group(keyframe_path(query), keyframe, options_.query_half_m, kPlaceSpacing_m);
  const std::vector<PointCells> points = in_cells(every_nth(group.points(), options_.points), options_.resolution_m);
  if (points.empty()) return fix;
  CertifiedOptions search;
  search.gap_m = options_.gap_m;
  search.max_boxes = options_.most_boxes;
  search.counts_window = false;
  const double unit = 256.0 / options_.resolution_m * static_cast<double>(points.size());
  search.wanted_bound = static_cast<std::uint32_t>(options_.most_m * unit);
  const CertifiedResult best = find_pose(state_->map, points, state_->window, search);
  if (!best.certified() || best.cost > search.wanted_bound) return fix;
  fix.T_map_keyframe = best.T_map_base;
  fix.mean_m = best.mean_cost_m;
  hold_against_places(query, fix);
  if (!fix.is_possible) return fix;
  search.gap_m = 0.0;
  search.excluded = {{fix.T_map_keyframe}};
  search.wanted_bound = best.cost + static_cast<std::uint32_t>(as_good_m(fix) * unit) + 1;
  const CertifiedResult elsewhere = find_pose(state_->map, points, state_->window, search);
  fix.elsewhere_m = elsewhere.mean_bound_m;
  fix.is_alone = elsewhere.stop == CertifiedStop::kNothingAllowed || elsewhere.bound >= search.wanted_bound;
  if (!fix.is_alone && elsewhere.cost < search.wanted_bound) fix.T_map_elsewhere = elsewhere.T_map_base;
  return fix;
}

// Compares with the nearest place that saw enough of the keyframe's walls. At the ends of this session a place saw half
// of its surroundings, so other places nearby are compared too; one contradiction is enough.
void SessionMap::hold_against_places(const Session& query, SessionFix& fix) const {
  bool is_first = true;
  for (const std::size_t place : places_near(fix.T_map_keyframe)) {
    const LoopEvidence evidence = weigh(query, fix.keyframe, session_.places[place], fix.T_map_keyframe);
    fix.is_possible = is_possible(evidence, options_.limits);
    if (is_first || fix.is_possible) {
      fix.reference_place = place;
      fix.evidence = evidence;
    }
    is_first = false;
    const LoopLimits& limits = options_.limits;
    const bool is_opposed = evidence.turned > limits.most_turned || evidence.contradiction > limits.most_contradiction;
    if (fix.is_possible || is_opposed) return;
  }
}

// Returns the nearest one first, and others that are as near as places are to each other.
std::vector<std::size_t> SessionMap::places_near(const Pose2& T_map_keyframe) const {
  const std::size_t nearest = place_near(T_map_keyframe);
  std::vector<std::pair<double, std::size_t>> others;
  for (std::size_t place = 0; place < session_.places.size(); ++place) {
    const double squared_m2 = squared_distance(session_.poses[session_.places[place]], T_map_keyframe);
    if (place != nearest && squared_m2 <= kOtherPlace_m * kOtherPlace_m) others.emplace_back(squared_m2, place);
  }
  std::sort(others.begin(), others.end());
  if (others.size() > kMostOthers) others.resize(kMostOthers);
  std::vector<std::size_t> places{nearest};
  for (const auto& [squared_m2, place] : others) places.push_back(place);
  return places;
}

std::size_t SessionMap::place_near(const Pose2& T_map_keyframe) const {
  const auto nearest = std::min_element(session_.places.begin(), session_.places.end(), [&](auto a, auto b) {
    return squared_distance(session_.poses[a], T_map_keyframe) < squared_distance(session_.poses[b], T_map_keyframe);
  });
  return static_cast<std::size_t>(nearest - session_.places.begin());
}

LoopEvidence SessionMap::weigh(const Session& query, std::size_t keyframe, std::size_t reference,
                               const Pose2& T_map_keyframe) const {
  const ScanGroup group(keyframe_path(query), keyframe, options_.query_half_m, kPlaceSpacing_m);
  const ScanGroup there(keyframe_path(session_), reference, options_.reference_half_m, kPlaceHeld_m);
  return weigh_loop(there, group, between(session_.poses[reference], T_map_keyframe));
}

std::optional<Pose2> SessionMap::find_elsewhere(const Session& query, std::size_t keyframe,
                                                const Pose2& T_map_keyframe) const {
  const ScanGroup group(keyframe_path(query), keyframe, options_.query_half_m, kPlaceSpacing_m);
  const std::vector<PointCells> points = in_cells(every_nth(group.points(), options_.points), options_.resolution_m);
  if (points.empty()) return std::nullopt;
  CertifiedOptions search;
  search.gap_m = options_.gap_m;
  search.max_boxes = options_.most_boxes;
  search.counts_window = false;
  search.excluded = {{T_map_keyframe}};
  search.wanted_bound =
      static_cast<std::uint32_t>(options_.most_m * 256.0 / options_.resolution_m * static_cast<double>(points.size()));
  const CertifiedResult best = find_pose(state_->map, points, state_->window, search);
  if (best.cost > search.wanted_bound) return std::nullopt;
  const std::size_t reference = session_.places[place_near(best.T_map_base)];
  if (!is_possible(weigh(query, keyframe, reference, best.T_map_base), options_.limits)) return std::nullopt;
  return best.T_map_base;
}

double SessionMap::as_good_m(const SessionFix& fix) const {
  return std::max(options_.as_good_m, options_.as_good_share * fix.mean_m);
}

// Infinite if there are no points.
double SessionMap::mean_beside_m(const Session& query, std::size_t keyframe, const Pose2& T_map_keyframe) const {
  const ScanGroup group(keyframe_path(query), keyframe, options_.query_half_m, kPlaceSpacing_m);
  const std::vector<PointCells> points = in_cells(every_nth(group.points(), options_.points), options_.resolution_m);
  if (points.empty()) return std::numeric_limits<double>::infinity();
  const PoseWindow beside{.centre = T_map_keyframe,
                          .half_x_m = kBesideHalf_m,
                          .half_y_m = kBesideHalf_m,
                          .half_theta_rad = kBesideHalf_rad};
  CertifiedOptions search;
  search.gap_m = options_.gap_m;
  search.max_boxes = options_.most_boxes;
  search.counts_window = false;
  search.starts = {T_map_keyframe};
  return find_pose(state_->map, points, beside, search).mean_cost_m;
}

bool SessionMap::fits_elsewhere(const Session& query, const SessionFix& fix, const Pose2& T_map_keyframe) const {
  const ScanGroup group(keyframe_path(query), fix.keyframe, options_.query_half_m, kPlaceSpacing_m);
  const std::vector<PointCells> points = in_cells(every_nth(group.points(), options_.points), options_.resolution_m);
  if (points.empty()) return false;
  const double unit = 256.0 / options_.resolution_m * static_cast<double>(points.size());
  CertifiedOptions search;
  search.gap_m = 0.0;
  search.max_boxes = options_.most_boxes;
  search.counts_window = false;
  search.excluded = {{T_map_keyframe}};
  search.wanted_bound = static_cast<std::uint32_t>((fix.mean_m + as_good_m(fix)) * unit) + 1;
  const CertifiedResult elsewhere = find_pose(state_->map, points, state_->window, search);
  return elsewhere.stop != CertifiedStop::kNothingAllowed && elsewhere.bound < search.wanted_bound;
}

bool SessionMap::fits(const Session& query, const SessionFix& fix, const Pose2& T_map_keyframe) const {
  return mean_beside_m(query, fix.keyframe, T_map_keyframe) <= fix.mean_m + as_good_m(fix);
}

bool SessionMap::has_walls_in_the_way(const Session& query, const Pose2& T_map_query) const {
  const FieldView field = state_->field.view();
  const auto is_wall = [&](const Point2& point) {
    const CellIndex cell = map_cell_at(point, options_.resolution_m);
    const std::int64_t x = std::int64_t{cell.x} - field.first_cell.x;
    const std::int64_t y = std::int64_t{cell.y} - field.first_cell.y;
    if (x < 0 || y < 0 || x >= field.width || y >= field.height) return false;
    return field.cells[static_cast<std::size_t>(y) * field.stride + static_cast<std::size_t>(x)] < kWallUnits;
  };
  for (std::size_t i = 1; i < query.poses.size(); ++i) {
    const Point2 from = (T_map_query * query.poses[i - 1]).translation();
    const Point2 way = (T_map_query * query.poses[i]).translation() - from;
    const double steps = std::ceil(way.norm() / kStep_m);
    for (double k = 0.0; k < steps; k += 1.0) {
      if (is_wall(from + k / steps * way)) return true;
    }
  }
  return false;
}

bool SessionMap::is_near(const Pose2& T_map_keyframe) const {
  return std::any_of(session_.poses.begin(), session_.poses.end(), [&](const Pose2& pose) {
    return squared_distance(pose, T_map_keyframe) < kDroveThere_m * kDroveThere_m;
  });
}

SessionMap::Test SessionMap::test(const Session& query, std::size_t keyframe, const Pose2& T_map_keyframe) const {
  if (!is_near(T_map_keyframe)) return Test::kElsewhere;
  return mean_beside_m(query, keyframe, T_map_keyframe) <= kFitsAtAll * options_.most_m ? Test::kFits
                                                                                        : Test::kDoesNotFit;
}

SessionMap::Test SessionMap::test_walls(const Session& query, std::size_t keyframe, const Pose2& T_map_keyframe) const {
  if (!is_near(T_map_keyframe)) return Test::kElsewhere;
  const std::size_t reference = session_.places[place_near(T_map_keyframe)];
  const LoopEvidence evidence = weigh(query, keyframe, reference, T_map_keyframe);
  if (is_possible(evidence)) return Test::kFits;
  return evidence.contradiction > LoopLimits{}.most_contradiction ? Test::kDoesNotFit : Test::kElsewhere;
}

std::size_t count_wall_points(const Session& session) { return to_points(session, kWallSpacing_m).size(); }

std::vector<std::size_t> places_to_look_for(const Session& query, std::size_t most) {
  const std::size_t count = std::min(most, query.places.size());
  std::vector<std::size_t> places;
  places.reserve(count);
  for (std::size_t first = 0; first < kQueriesApart; ++first) {
    for (std::size_t k = first; k < count; k += kQueriesApart)
      places.push_back(query.places[k * query.places.size() / count]);
  }
  return places;
}

std::vector<std::size_t> keyframes_beside(const Session& query, std::size_t keyframe) {
  std::vector<std::size_t> beside;
  for (const double away_m : kBeside_m) {
    const double path_m = query.path_m[keyframe] + away_m;
    if (path_m < 0.0 || path_m > query.path_m.back()) continue;
    const auto at = std::lower_bound(query.path_m.begin(), query.path_m.end(), path_m);
    beside.push_back(static_cast<std::size_t>(at - query.path_m.begin()));
  }
  return beside;
}

bool are_at_one_place(const Session& session, std::size_t a, std::size_t b) {
  return std::fabs(session.path_m[a] - session.path_m[b]) <= kSamePlace_m;
}

std::vector<std::size_t> agreeing(const Session& query, const std::vector<SessionFix>& fixes,
                                  const AgreementLimits& limits) {
  const auto agree = [&](const SessionFix& a, const SessionFix& b) {
    const std::size_t from = a.keyframe;
    const std::size_t to = b.keyframe;
    const Pose2 off = between(between(query.poses[from], query.poses[to]), between(a.T_map_keyframe, b.T_map_keyframe));
    const double way_m = std::fabs(query.path_m[to] - query.path_m[from]);
    return translation_length(off) <= limits.near_m + limits.drift_m_per_m * way_m &&
           std::fabs(wrap_angle(off.theta_rad)) <= limits.near_rad + limits.drift_rad_per_m * way_m;
  };
  std::vector<std::size_t> most;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    if (!fixes[i].is_alone) continue;
    std::vector<std::size_t> with;
    for (std::size_t j = 0; j < fixes.size(); ++j) {
      if (fixes[j].is_alone && agree(fixes[i], fixes[j])) with.push_back(j);
    }
    if (with.size() > most.size()) most = std::move(with);
  }
  if (most.size() < limits.least) most.clear();
  return most;
}

}  // namespace gdtslam
