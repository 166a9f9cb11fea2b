#include "back_end.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/wheels/pose_filter.hpp"
#include "held_path.hpp"

namespace gdtslam {
namespace {

// Noise of a match against the local map: the noise of a scan's points, the number of independent ones, and the least
// error, because neighbours are matched against the same cells. The noise does not add up from step to step, since each
// keyframe is matched with all earlier ones in the local map: of a scan that lies on the mean of n others, a share of 2
// / (n + 1) stays in the path, 0.15 for a dozen. Larger errors show beside the wheels, and stay if keyframes are far
// apart.
constexpr double kStepPointNoise_m = 0.02;
constexpr double kStepIndependent = 20.0 / (0.15 * 0.15);
constexpr double kEnoughPoints = 60.0;
constexpr double kStepLeastShape = 1.0e-9;
constexpr double kOverlap_m = 1.0;        // path length within which scans overlap with each other
constexpr double kFrontStretch_m = 15.0;  // path length of a local map of the front end
constexpr double kStepFloor_m = 0.0015;
constexpr double kStepFloor_rad = 0.0003;
constexpr double kStepLeastShare = 0.01;
// Least error of the wheels.
constexpr double kLeastWheels_m = 0.002;
constexpr double kLeastWheels_rad = 0.0005;
constexpr double kUnmeasured_m = 5.0;  // a larger sigma marks a step that no odometry measured, or no match
constexpr double kUnmeasured_rad = 1.0;
constexpr double kLeastForDoubt = 0.3;  // least factor of the wheels' variance in covariances
// In a turn in which the two disagree, the wheels get slightly more weight: their own heading counts then, and its
// error moves the later path as that of the matches does.
constexpr double kTurnOfWheels = 0.9;
constexpr int kTimesCarried = 3;  // repetitions for scans without a kept keyframe: their poses are the graph's
constexpr std::size_t kMostCovariances = 400;  // places with computed covariances; the rest are interpolated

Matrix3 least_of_wheels() {
  return Matrix3::diagonal(square(kLeastWheels_m), square(kLeastWheels_m), square(kLeastWheels_rad));
}

// The adjustment moves the first pose slightly too.
void to_frame_of_first(std::vector<Pose2>& poses) {
  if (poses.empty()) return;
  const Pose2 T_first_map = inverse(poses.front());
  for (Pose2& pose : poses) pose = T_first_map * pose;
}

std::vector<Pose2> those_at(const std::vector<std::size_t>& indices, const std::vector<Pose2>& poses) {
  std::vector<Pose2> chosen;
  chosen.reserve(indices.size());
  for (const std::size_t index : indices) chosen.push_back(poses[index]);
  return chosen;
}

}  // namespace

BackEnd::BackEnd(const BackEndOptions& options)
    : options_(options),
      loops_(options.loops, options.live),
      counter_(options.loops),
      scans_(options.scratch_folder, ByteShelf::kFewBytes),
      shelf_(options.scratch_folder, options.shelf_bytes) {}

void BackEnd::take(const KeptScan& scan, const MatchResult& result) {
  if (keyframes_taken_ > 0) follow(result);
  shelf_.put(scan);
  if (!result.merged && keyframes_taken_ > 0) {
    scans_.put({between(T_map_keyframe_, result.T_map_base), keyframes_taken_ - 1});
    return;
  }
  scans_.put({{}, keyframes_taken_++});
  add_keyframe(result, scan);
}

// Adds one scan. If match and prediction differ by more than their errors allow, either may be wrong by the whole
// difference, for example if a robot without odometry drove unseen along a corridor until something showed its
// position. For a turn that the scan does not fit without, only the wheels can be wrong.
void BackEnd::follow(const MatchResult& result) {
  const Pose2& step = result.T_odometry_step;
  const Matrix3 carried = adjoint_matrix(inverse(step));
  const double m = square(result.odometry_sigma_m);
  const double rad = square(result.odometry_sigma_rad);
  T_wheels_ = T_wheels_ * step;
  if (result.odometry_sigma_m < kUnmeasured_m) {
    travel_.path_m += translation_length(step);
    travel_.turned_rad += std::fabs(step.theta_rad);
  } else {
    travel_.besides += Matrix3::diagonal(m, m, rad);
    travel_.is_measured = false;
  }
  wheels_covariance_ = carried * times_transposed(wheels_covariance_, carried) + Matrix3::diagonal(m, m, rad);
  leaps_ = carried * times_transposed(leaps_, carried);
  match_leaps_ = carried * times_transposed(match_leaps_, carried);
  if (const std::optional<Tangent2> off = find_leap(result)) {
    leaps_ += outer(*off, *off);
    const Tangent2 of_match{(*off)[0], (*off)[1], result.is_turn_open ? (*off)[2] : 0.0};
    match_leaps_ += outer(of_match, of_match);
  }
  if (const std::optional<double> turn_rad = turn_leap_.take(result)) {
    leaps_ += Matrix3::diagonal(0.0, 0.0, square(kTurnOfWheels * *turn_rad));
    match_leaps_ += Matrix3::diagonal(0.0, 0.0, square(*turn_rad));
  }
}

void BackEnd::add_keyframe(const MatchResult& result, KeptScan points) {
  Keyframe keyframe{
      .scan = std::move(points), .T_map_base = result.T_map_base, .path_m = 0.0, .steps = {}, .travel = {}};
  if (keyframes_taken_ <= 1) {
    chain_.take(result.T_map_base, {}, known_, counter_.is_place(0.0));
  } else {
    const double step_m = translation_length(between(T_map_keyframe_, result.T_map_base));
    travelled_m_ += step_m;
    stretch_m_ += step_m;
    const KeptScan known = result.accepted ? known_.known_part(keyframe.scan, result.T_map_base) : KeptScan{};
    keyframe.steps = steps_to(result, known);
    keyframe.steps[0].unseen = update_unseen(result, known);
    keyframe.steps[0].blind = chain_.take(result.T_map_base, known, known_, counter_.is_place(travelled_m_));
    keyframe.travel = travel_;
    keyframe.travel.besides += least_of_wheels() + leaps_;
  }
  keyframe.scan.corners = {};
  keyframe.travel.is_matched = result.accepted;
  keyframe.travel.is_way_known = knows_way(keyframe.scan, inverse(T_wheels_).translation());
  keyframe.path_m = travelled_m_;
  if (stretch_m_ > kFrontStretch_m) {
    known_.begin_stretch();
    stretch_m_ = 0.0;
  }
  known_.add(to_points(keyframe.scan), result.T_map_base);
  T_map_keyframe_ = result.T_map_base;
  T_wheels_ = {};
  wheels_covariance_ = {};
  leaps_ = {};
  match_leaps_ = {};
  travel_ = {};
  loops_.take(std::move(keyframe));
}

// Along directions that no known surface shows, the pose in the local map is as uncertain as the wheels since the last
// such surface.
Matrix3 BackEnd::update_unseen(const MatchResult& result, const KeptScan& known) {
  const Matrix3 carried = adjoint_matrix(between(result.T_map_base, T_map_keyframe_));
  covariance_ = carried * times_transposed(covariance_, carried) + wheels_covariance_ + least_of_wheels() + leaps_;
  if (!result.accepted) return covariance_;
  const MatchInformation match = match_information(known);
  covariance_ = inverse(inverse(covariance_) + match.matrix);
  Matrix3 unseen = Matrix3::identity();
  unseen -= match.held;
  return unseen * times_transposed(covariance_, unseen);
}

// The front end's pose comes from points and wheels; the second step is that of the wheels alone. A scan far from its
// map may have been matched with something else, so the cautious information takes that distance as point noise. A scan
// that no match confirmed adds nothing to the wheels.
MeasuredSteps BackEnd::steps_to(const MatchResult& result, const KeptScan& known) const {
  const std::size_t points = known.surface.size();
  const double share = std::max(kStepLeastShare, std::min(1.0, static_cast<double>(points) / kEnoughPoints));
  const ShapeOfOne one = shape_of_one(surface_shape(known), points, kStepLeastShape, feigned_shape(known));
  const Matrix3 lone = lone_information(known);
  const double step_m = translation_length(between(T_map_keyframe_, result.T_map_base));
  const double staying = std::min(1.0, 2.0 * step_m / (kOverlap_m + step_m));
  const double floor_m2 = square(kStepFloor_m) + square(staying * result.match_sigma_m);
  const double floor_rad2 = square(kStepFloor_rad) + square(staying * result.match_sigma_rad);
  const Matrix3 floor = Matrix3::diagonal(floor_m2, floor_m2, floor_rad2);
  const Matrix3 nothing = Matrix3::diagonal(square(kUnmeasured_m), square(kUnmeasured_m), square(kUnmeasured_rad));
  const Matrix3 by_wheels = wheels_covariance_ + least_of_wheels() + leaps_;
  const auto with_noise = [&](double noise_m) {
    if (!result.accepted) return inverse(nothing);
    const Matrix3 of_match = inverse(kStepIndependent * share / square(noise_m) * one.shape + lone);
    return inverse(one.believed * times_transposed(of_match, one.believed) + floor + match_leaps_);
  };
  return {MeasuredStep{between(T_map_keyframe_, result.T_map_base),
                       with_noise(kStepPointNoise_m),
                       with_noise(std::max(kStepPointNoise_m, result.mean_cost_m)),
                       {}},
          MeasuredStep{T_wheels_, inverse(by_wheels), inverse(by_wheels), {}}};
}

// Does the work once: as_driven() may follow a stopped finish().
void BackEnd::take_kept() {
  if (!kept_.empty()) return;
  const std::vector<bool>& is_pruned = loops_.is_pruned();
  for (std::size_t i = 0; i < is_pruned.size(); ++i) {
    if (!is_pruned[i]) kept_.push_back(i);
  }
  std::vector<KeptScan> scans_of_kept = loops_.take_scans();
  kept_scans_.reserve(kept_.size());
  for (KeptScan& scan : scans_of_kept) kept_scans_.emplace_back(std::exchange(scan, {}));
  Shelf<Scan>::Reader scans(scans_);
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    if (scans.next().keyframe == keyframes_.size()) keyframes_.push_back(i);  // the first scan of this keyframe
  }
}

std::vector<Pose2> BackEnd::poses_of_scans(const std::vector<Pose2>& keyframes) const {
  std::vector<Pose2> poses;
  poses.reserve(scans_.size());
  Shelf<Scan>::Reader scans(scans_);
  while (poses.size() < scans_.size()) {
    const Scan scan = scans.next();
    poses.push_back(keyframes[scan.keyframe] * scan.T_keyframe_base);
  }
  return poses;
}

void BackEnd::warn_of_shelf() const {
  const std::string& trouble = shelf_.bytes().trouble();
  if (!trouble.empty() && options_.live.warn)
    options_.live.warn("the points of all scans stayed in memory: " + trouble);
}

// Keyframes that are not kept, at a place that was passed often, move with the nearest kept one.
JointResult BackEnd::adjust_keyframes(const LoopCloser& closer, std::vector<Pose2>& keyframes, WorkerPool& workers,
                                      const Progress& progress) const {
  std::vector<PoseRelation> held = held_path(closer.measured(), kept_);
  for (const PoseRelation& loop : held_loops(closer.graph(), closer.places(), kept_)) held.push_back(loop);
  const std::vector<Pose2> before = those_at(kept_, keyframes);
  std::vector<Pose2> after = before;
  const JointResult result =
      JointAdjustment(kept_scans_, std::move(held), options_.joint)
          .run(
              after, workers, [&](double share) { progress("adjusting keyframes", share); }, options_.device);
  if (kept_.size() < keyframes.size()) carry_with_nearest(before, after, keyframes);
  for (std::size_t k = 0; k < kept_.size(); ++k) keyframes[kept_[k]] = after[k];
  return result;
}

void BackEnd::adjust_scans(const std::vector<Pose2>& keyframes, std::vector<Pose2>& poses, WorkerPool& workers,
                           const Progress& progress) const {
  const std::vector<Pose2> kept = those_at(kept_, keyframes);
  const ScanAdjustment adjustment(kept_scans_, kept, options_.scans);
  LinePairs lines(kept_scans_, workers, options_.device);
  Shelf<KeptScan>::Reader shelf(shelf_);
  Shelf<Scan>::Reader scans(scans_);
  const std::size_t at_once = lines.at_once() / options_.scans.most_keyframes;
  std::vector<LineScan> taken(at_once);
  std::vector<MovingScan> moving;
  for (std::size_t first = 0; first < poses.size(); first += at_once) {
    const std::size_t count = std::min(at_once, poses.size() - first);
    std::vector<KeptScan> points(count);
    moving.clear();
    for (std::size_t i = 0; i < count; ++i) {
      points[i] = shelf.next();
      const std::size_t keyframe = scans.next().keyframe;
      const std::optional<std::size_t> last = number_in(kept_, keyframe);
      const bool is_adjusted = last && keyframes_[keyframe] == first + i;  // with the others
      if (!is_adjusted) moving.push_back({i, last, poses[first + i]});
    }
    workers.run(moving.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::size_t k = begin; k < end; ++k) taken[moving[k].number] = LineScan(points[moving[k].number]);
    });
    const auto of_kept = std::stable_partition(moving.begin(), moving.end(), [](const auto& s) { return !s.last; });
    for (int times = 1; times < kTimesCarried; ++times) {
      adjustment.adjust(taken, std::span(moving.begin(), of_kept), lines, workers);
    }
    adjustment.adjust(taken, moving, lines, workers);
    for (const MovingScan& scan : moving) poses[first + scan.number] = scan.pose;
    progress("adjusting scans", static_cast<double>(first + count) / static_cast<double>(poses.size()));
  }
}

// The graph for the covariances and the keyframes of its nodes: the places, or all keyframes of a drive with a single
// place, whose graph would hold no information. Loops correct the stated weight of a chain only if they tie it; without
// loops the chain may be as bad as stated.
BackEnd::CautiousGraph BackEnd::cautious_graph(const LoopCloser& closer) const {
  PoseGraph graph = closer.graph();
  if (closer.places().size() != 1) {
    graph.path = closer.measured().matches(&MeasuredStep::cautious);
    graph.wheels = closer.measured().wheels(kLeastForDoubt);
    return {std::move(graph), closer.places()};
  }
  MeasuredPath steps = closer.measured();
  for (std::size_t keyframe = 1; keyframe < keyframes_.size(); ++keyframe) steps.add_place(keyframe);
  graph.poses = closer.poses();
  graph.path = steps.matches(&MeasuredStep::cautious);
  graph.wheels = steps.wheels(kLeastForDoubt);
  return {std::move(graph), steps.places()};
}

// Interpolates linearly over the keyframes in between.
std::vector<Matrix3> BackEnd::covariances_of_scans(const LoopCloser& closer) const {
  const auto [graph, places] = cautious_graph(closer);
  if (places.empty()) return {};
  std::vector<std::size_t> nodes;
  for (std::size_t i = 0; i < places.size(); i += places.size() / kMostCovariances + 1) nodes.push_back(i);
  if (nodes.back() + 1 < places.size()) nodes.push_back(places.size() - 1);
  std::vector<std::size_t> at;
  at.reserve(nodes.size());
  for (const std::size_t node : nodes) at.push_back(places[node]);
  const std::vector<Matrix3> of_keyframes = spread_covariances(at, covariances_in_map(graph, nodes), keyframes_.size());
  std::vector<Matrix3> covariances;
  covariances.reserve(scans_.size());
  Shelf<Scan>::Reader scans(scans_);
  while (covariances.size() < scans_.size()) covariances.push_back(of_keyframes[scans.next().keyframe]);
  return covariances;
}

void BackEnd::visit_keyframes(const std::function<void(std::size_t, const KeptScan&)>& visit) const {
  Shelf<KeptScan>::Reader shelf(shelf_);
  std::size_t next = 0;
  for (std::size_t i = 0; next < keyframes_.size(); ++i) {
    const KeptScan scan = shelf.next();
    if (keyframes_[next] == i) visit(next++, scan);
  }
}

BackEndResult BackEnd::as_driven() {
  loops_.abandon();
  take_kept();
  BackEndResult result;
  result.poses = poses_of_scans(path_.poses);
  result.keyframes = keyframes_;
  return result;
}

BackEndResult BackEnd::finish(const Progress& progress) {
  const auto closing = [&](double share, int round) {
    progress("closing loops", (share + round) / (options_.loops.rounds + 1));
  };
  LoopCloser& closer = loops_.end([&](double share) { closing(share, 0); });
  WorkerPool workers(threads_meant(options_.threads));
  closer.run(closing, workers);
  warn_of_shelf();
  take_kept();
  std::vector<Pose2> keyframes = closer.poses();
  BackEndResult result;
  result.is_closed = true;
  result.covariances = covariances_of_scans(closer);
  result.joint = adjust_keyframes(closer, keyframes, workers, progress);
  result.poses = poses_of_scans(keyframes);
  adjust_scans(keyframes, result.poses, workers, progress);
  kept_scans_ = {};
  result.keyframes = keyframes_;
  result.graph = closer.graph();
  to_frame_of_first(result.poses);
  to_frame_of_first(result.graph.poses);
  result.places = closer.places();
  result.counts = closer.counts();
  result.factors = closer.measured().factors();
  result.wheels = closer.measured().wheel_bias();
  return result;
}

}  // namespace gdtslam
