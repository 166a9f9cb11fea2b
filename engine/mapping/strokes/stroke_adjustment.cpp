#include "stroke_adjustment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/core/quantile.hpp"
#include "engine/mapping/graph/matrix3.hpp"
#include "levelling.hpp"
#include "sparse_rows.hpp"
#include "surfel_pairs.hpp"

namespace gdtslam {
namespace {

constexpr int kSearchEvery = 2;     // iterations from one search for pairs to the next
constexpr int kFirstElevation = 2;  // iteration from which on elevations are corrected
constexpr int kFirstEstimate = 4;   // iteration from which on variances are estimated
// Corrections found with a prior are smaller than the true ones. With 1.6 a flat floor keeps a tilt of 0.1 deg, with 1
// true tilts lose a third.
constexpr double kFoundShare = 1.3;
constexpr double kLeastTiltStep_rad = 1.0e-4;
constexpr double kSmooth = 4.0;                 // neighbours among the elevations differ by half of their size
constexpr double kLeastElevation_rad = 1.0e-3;  // smaller corrections are left out
constexpr std::uint32_t kFirstStrokes = 10;
constexpr double kAround_m = 4.0;  // an error of the elevation tells little as near as this
constexpr double kAnchor = 1.0e8;  // information of the start, where covariances are wanted

using Float3 = std::array<float, 3>;

Float3 to_floats(double factor, const Point3& v) {
  return {static_cast<float>(factor * v.x()), static_cast<float>(factor * v.y()), static_cast<float>(factor * v.z())};
}

Float3 unit(std::size_t axis, double value = 1.0) {
  Float3 v{};
  v[axis] = static_cast<float>(value);
  return v;
}

/// A surfel's place among the knots.
struct Placed {
  PathCorrection::Moment moment;
  PathCorrection::ElevationPlace elevation;
};

/// Blocks of three unknowns: shift and turn of each knot, then the elevations.
struct Blocks {
  std::size_t knots = 0;
  [[nodiscard]] std::size_t elevation(std::size_t knot) const { return 2 * knots + knot / 3; }
  [[nodiscard]] std::size_t count() const { return elevation(PathCorrection::kElevationKnots); }
  /// Neighbours in time.
  [[nodiscard]] std::vector<BlockSystem::Pair> chain() const {
    std::vector<BlockSystem::Pair> pairs;
    for (std::size_t a = 0; a < 2 * knots; ++a) {
      for (std::size_t b = a + 1; b < std::min(2 * knots, a / 2 * 2 + 4); ++b) pairs.emplace_back(b, a);
    }
    return pairs;
  }
};

RowEntry entry(std::size_t block, const Float3& derivative) { return {static_cast<std::uint32_t>(block), derivative}; }

/// The distance of a surfel from its partner's plane, and its weight.
struct PairDistance {
  double distance_m = 0.0;
  double weight = 0.0;
};

/// The equations of an adjustment, and the steps of an iteration.
class StrokeProblem {
 public:
  StrokeProblem(const std::vector<Surfel>& surfels, const StrokeAdjustmentOptions& options, WorkerPool& workers,
                PathCorrection& correction)
      : options_(options),
        correction_(correction),
        surfels_(surfels),
        now_(surfels),
        blocks_{correction.knots.size()},
        rows_(blocks_.count(), blocks_.chain(), workers) {
    placed_.reserve(surfels.size());
    for (const Surfel& surfel : surfels) {
      const PathCorrection::Moment moment = correction.at_scan(surfel.scan);
      placed_.push_back({moment, correction.at_elevation(surfel.elevation_rad, moment.is_upward)});
    }
  }

  void find_pairs() { pairs_ = find_surfel_pairs(now_, {}); }
  void weigh(double scale_m, double gate_m);
  void linearise(bool with_elevation);
  void step();
  void place();
  void level();
  [[nodiscard]] std::vector<Surfel> surfels_around_start() const;
  void estimate_variances();
  [[nodiscard]] double rms_m() const;
  [[nodiscard]] std::size_t pairs() const { return used_; }
  [[nodiscard]] Tangent3 rms_correction() const;
  [[nodiscard]] Tangent3 sigma();

 private:
  void add_pair(const SurfelPair& pair, const PairDistance& distance, bool with_elevation);
  void add_knot(std::size_t k);
  void add_steps(std::size_t k);
  void add_elevations();

  StrokeAdjustmentOptions options_;
  const double most_elevation_rad_ = options_.elevation_rad;
  bool is_elevation_right_ = false;  // it needs no correction
  PathCorrection& correction_;
  const std::vector<Surfel>& surfels_;
  std::vector<Surfel> now_;
  Blocks blocks_;
  SparseRows rows_;
  std::vector<Placed> placed_;
  std::vector<SurfelPair> pairs_;
  std::vector<PairDistance> distances_;
  std::size_t used_ = 0;
};

void StrokeProblem::place() {
  for (std::size_t k = 0; k < surfels_.size(); ++k) {
    const PathCorrection::Moment& moment = placed_[k].moment;
    now_[k].mean = correction_.corrected(surfels_[k].mean, surfels_[k].elevation_rad, moment);
    now_[k].normal = exp_so3(correction_.correction(moment).tail<3>()) * surfels_[k].normal;
    if (now_[k].normal.dot(moment.axis - surfels_[k].mean) < 0.0) now_[k].normal = -now_[k].normal;
  }
}

void StrokeProblem::weigh(double scale_m, double gate_m) {
  distances_.assign(pairs_.size(), {});
  used_ = 0;
  const double sq_scale = scale_m * scale_m;
  for (std::size_t begin = 0; begin < pairs_.size();) {
    double sum = 0.0;
    std::size_t end = begin;
    for (; end < pairs_.size() && pairs_[end].first == pairs_[begin].first; ++end) {
      const Surfel& other = now_[pairs_[end].second];
      const double distance_m = other.normal.dot(now_[pairs_[end].first].mean - other.mean);
      if (!(std::fabs(distance_m) < gate_m)) continue;
      distances_[end] = {distance_m, square(sq_scale / (sq_scale + distance_m * distance_m))};  // Geman and McClure
      sum += distances_[end].weight;
      ++used_;
    }
    const double share = std::min(1.0, options_.most_weight / std::max(sum, 1.0e-9)) / square(options_.point_m);
    for (; begin < end; ++begin) distances_[begin].weight *= share;
  }
}

void StrokeProblem::add_pair(const SurfelPair& pair, const PairDistance& distance, bool with_elevation) {
  const Point3& normal = now_[pair.second].normal;
  std::array<std::array<RowEntry, 4>, 2> knots;
  std::array<RowEntry, 4> elevations;
  for (std::size_t end = 0; end < 2; ++end) {
    const std::uint32_t surfel = end == 0 ? pair.first : pair.second;
    const double sign = end == 0 ? 1.0 : -1.0;
    const auto& [moment, elevation] = placed_[surfel];
    const Point3 arm = now_[surfel].mean - moment.centre;
    const Point3 by_turn = arm.cross(normal);
    const double by_elevation = -sign * normal.dot(moment.left.cross(now_[surfel].mean - moment.axis));
    for (std::size_t side = 0; side < 2; ++side) {
      const double share = sign * (side == 0 ? 1.0 - moment.share : moment.share);
      const std::size_t block = 2 * (moment.knot + side);
      knots[end][2 * side] = entry(block, to_floats(share, normal));
      knots[end][2 * side + 1] = entry(block + 1, to_floats(share, by_turn));
      const std::size_t knot = elevation.knot + side;
      const double of_knot = side == 0 ? 1.0 - elevation.share : elevation.share;
      elevations[2 * end + side] = entry(blocks_.elevation(knot), unit(knot % 3, of_knot * by_elevation));
    }
  }
  if (with_elevation) {
    const std::span<const RowEntry> all(elevations);
    rows_.add({knots[0], knots[1], all.subspan(0, 1), all.subspan(1, 1), all.subspan(2, 1), all.subspan(3, 1)},
              distance.weight, distance.distance_m);
  } else {
    rows_.add({knots[0], knots[1]}, distance.weight, distance.distance_m);
  }
}

void StrokeProblem::add_knot(std::size_t k) {
  const std::array sigmas{options_.place_m,  options_.place_m,  options_.height_m,
                          options_.tilt_rad, options_.tilt_rad, options_.heading_rad};
  for (std::size_t i = 0; i < 6; ++i) {
    const RowEntry one = entry(2 * k + i / 3, unit(i % 3));
    rows_.add({std::span(&one, 1)}, 1.0 / square(sigmas[i]), correction_.knots[k][static_cast<Eigen::Index>(i)]);
  }
}

// Changes from one knot to the next. The height changes by the way times the mean pitch: nose down is a positive turn
// about the left.
void StrokeProblem::add_steps(std::size_t k) {
  const Tangent3 change = correction_.knots[k + 1] - correction_.knots[k];
  const double step_s = correction_.step_s(k);
  const std::array sigmas{options_.place_step_m,  options_.place_step_m,  0.0,
                          options_.tilt_step_rad, options_.tilt_step_rad, options_.heading_step_rad};
  for (std::size_t i = 0; i < 6; ++i) {
    if (i == 2) continue;
    const std::size_t block = 2 * k + i / 3;
    const std::array both{entry(block, unit(i % 3, -1.0)), entry(block + 2, unit(i % 3))};
    rows_.add({both}, 1.0 / (square(sigmas[i]) * step_s), change[static_cast<Eigen::Index>(i)]);
  }
  const PathCorrection::Moment& from = correction_.knot_moment(k);
  const Point3 ahead = from.left.cross(Point3::UnitZ());
  const Point3 by_turn = 0.5 * ahead.dot(correction_.knot_moment(k + 1).centre - from.centre) * from.left;
  const Point3 turns = correction_.knots[k].tail<3>() + correction_.knots[k + 1].tail<3>();
  const std::array height{entry(2 * k, unit(2, -1.0)), entry(2 * k + 1, to_floats(1.0, by_turn)),
                          entry(2 * k + 2, unit(2)), entry(2 * k + 3, to_floats(1.0, by_turn))};
  rows_.add({height}, 1.0 / (square(options_.height_step_m) * step_s), change[2] + by_turn.dot(turns));
}

// Corrections of the elevation are small and smooth.
void StrokeProblem::add_elevations() {
  for (std::size_t k = 0; k < PathCorrection::kElevationKnots; ++k) {
    const RowEntry one = entry(blocks_.elevation(k), unit(k % 3));
    const double weight = 1.0 / square(options_.elevation_rad);
    rows_.add({std::span(&one, 1)}, weight, correction_.elevation_knots_rad[k]);
    if ((k + 1) % PathCorrection::kKnotsOfAStroke == 0) continue;
    const std::array both{entry(blocks_.elevation(k), unit(k % 3, -1.0)),
                          entry(blocks_.elevation(k + 1), unit((k + 1) % 3))};
    const std::span<const RowEntry> pieces(both);
    rows_.add({pieces.first(1), pieces.last(1)}, kSmooth * weight,
              correction_.elevation_knots_rad[k + 1] - correction_.elevation_knots_rad[k]);
  }
}

void StrokeProblem::linearise(bool with_elevation) {
  with_elevation = with_elevation && !is_elevation_right_;
  rows_.clear();
  for (std::size_t k = 0; k < blocks_.knots; ++k) add_knot(k);
  for (std::size_t k = 0; k + 1 < blocks_.knots; ++k) add_steps(k);
  add_elevations();
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    if (distances_[k].weight > 0.0) add_pair(pairs_[k], distances_[k], with_elevation);
  }
}

void StrokeProblem::step() {
  const std::vector<Tangent2> step = rows_.solve();
  if (step.empty()) return;
  for (std::size_t k = 0; k < blocks_.knots; ++k) {
    for (std::size_t i = 0; i < 6; ++i) {
      correction_.knots[k][static_cast<Eigen::Index>(i)] += step[2 * k + i / 3][i % 3];
    }
  }
  for (std::size_t k = 0; k < PathCorrection::kElevationKnots; ++k) {
    correction_.elevation_knots_rad[k] += step[blocks_.elevation(k)][k % 3];
  }
}

std::vector<Surfel> StrokeProblem::surfels_around_start() const {
  std::vector<Surfel> near;
  for (std::size_t k = 0; k < now_.size() && now_[k].stroke < kFirstStrokes; ++k) {
    if ((now_[k].mean - placed_[k].moment.centre).norm() < kAround_m) near.push_back(now_[k]);
  }
  return near;
}

void StrokeProblem::level() {
  std::array<std::vector<double>, 2> tilts;
  for (const Tangent3& knot : correction_.knots) {
    tilts[0].push_back(-knot[3]);
    tilts[1].push_back(-knot[4]);
  }
  const std::array<double, 2> turn_rad = find_levelling_turn(now_, {upper_median(tilts[0]), upper_median(tilts[1])});
  const Point3 turn(turn_rad[0], turn_rad[1], 0.0);
  for (std::size_t k = 0; k < blocks_.knots; ++k) {
    correction_.knots[k].tail<3>() += turn;
    correction_.knots[k].head<3>() += turn.cross(correction_.knot_moment(k).centre);
  }
  place();
  const double height_m = find_floor_height(surfels_around_start(), correction_.knots.front()[2]);
  for (Tangent3& knot : correction_.knots) knot[2] -= height_m;
  place();
}

// Each variance follows the corrections that were found with it. If nothing is to be corrected, it falls to nothing
// from iteration to iteration.
void StrokeProblem::estimate_variances() {
  double squares = 0.0;
  for (std::size_t k = 0; k + 1 < blocks_.knots; ++k) {
    const Tangent3 change = correction_.knots[k + 1] - correction_.knots[k];
    squares += (square(change[3]) + square(change[4])) / correction_.step_s(k);
  }
  const double rms = std::sqrt(squares / (2.0 * static_cast<double>(blocks_.knots - 1)));
  options_.tilt_step_rad = kFoundShare * std::max(rms, kLeastTiltStep_rad);
  if (is_elevation_right_) return;
  squares = 0.0;
  for (const double knot_rad : correction_.elevation_knots_rad) squares += square(knot_rad);
  options_.elevation_rad =
      std::min(most_elevation_rad_, std::sqrt(squares / static_cast<double>(PathCorrection::kElevationKnots)));
  if (options_.elevation_rad >= kLeastElevation_rad) return;
  is_elevation_right_ = true;
  std::fill(correction_.elevation_knots_rad.begin(), correction_.elevation_knots_rad.end(), 0.0);
}

double StrokeProblem::rms_m() const {
  double squares = 0.0;
  double weights = 0.0;
  for (const PairDistance& one : distances_) {
    squares += one.weight * square(one.distance_m);
    weights += one.weight;
  }
  return weights > 0.0 ? std::sqrt(squares / weights) : 0.0;
}

Tangent3 StrokeProblem::rms_correction() const {
  Tangent3 squares = Tangent3::Zero();
  for (const Tangent3& knot : correction_.knots) squares += knot.cwiseAbs2();
  return (squares / static_cast<double>(blocks_.knots)).cwiseSqrt();
}

Tangent3 StrokeProblem::sigma() {
  for (std::size_t i = 2; i < 5; ++i) {
    const RowEntry one = entry(i / 3, unit(i % 3));
    rows_.add({std::span(&one, 1)}, kAnchor, 0.0);
  }
  Tangent3 sigma = Tangent3::Zero();
  if (rows_.solve().empty()) return sigma;
  const std::size_t knot = blocks_.knots / 2;
  for (std::size_t i = 2; i < 5; ++i) {
    const std::size_t block = 2 * knot + i / 3;
    const std::vector<Tangent2> column = rows_.covariance_column(block, i % 3);
    if (!column.empty()) sigma[static_cast<Eigen::Index>(i)] = std::sqrt(std::max(0.0, column[block][i % 3]));
  }
  return sigma;
}

}  // namespace

StrokeAdjustment adjust_strokes(const std::vector<Surfel>& surfels, const StrokeAdjustmentOptions& options,
                                WorkerPool& workers, PathCorrection& correction,
                                const std::function<void(double)>& progress) {
  StrokeAdjustment found;
  found.surfels = surfels.size();
  StrokeProblem problem(surfels, options, workers, correction);
  problem.place();
  double scale_m = options.first_scale_m;
  double gate_m = options.first_gate_m;
  for (int k = 0; k < options.iterations; ++k) {
    if (k % kSearchEvery == 0) problem.find_pairs();
    if (k == 0) {
      problem.weigh(options.last_scale_m, options.last_gate_m);
      found.rms_before_m = problem.rms_m();
    }
    problem.weigh(scale_m, gate_m);
    scale_m = std::max(options.last_scale_m, options.scale_narrowing * scale_m);
    gate_m = std::max(options.last_gate_m, options.gate_narrowing * gate_m);
    problem.linearise(k >= kFirstElevation);
    problem.step();
    problem.place();
    problem.level();
    if (k >= kFirstEstimate) problem.estimate_variances();
    progress(static_cast<double>(k + 1) / static_cast<double>(options.iterations));
  }
  problem.weigh(options.last_scale_m, options.last_gate_m);
  found.pairs = problem.pairs();
  found.rms_m = problem.rms_m();
  found.rms_correction = problem.rms_correction();
  found.sigma = problem.sigma();
  return found;
}

}  // namespace gdtslam
