#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "engine/core/quantile.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "observability.hpp"
#include "self_calibration.hpp"

namespace gdtslam::calib {
namespace {

constexpr double kDifference = 0.002;   // step of a scaled parameter: 6 micrometres of a bar, 0.004 deg of the zero
constexpr double kSettledShift = 0.05;  // largest step, in prior sigmas; below it, changing pairs dominate
constexpr std::size_t kFewestPairs = 100;
constexpr double kHuberSigmas = 1.5;
constexpr double kCell_m = 0.25;   // neighbours of a plane are within one cell
constexpr double kFlat = 0.02;     // limit of the variance across a plane over the smaller one along it
constexpr double kWide_m = 0.015;  // least standard deviation along the plane; else neighbours are in a line

/// A point of one stroke and the plane through its neighbours in the next.
struct StrokePair {
  static constexpr std::size_t kNeighbours = 10;
  std::uint32_t point = 0;
  std::array<std::uint32_t, kNeighbours> plane{};  ///< points of the plane
  Point3 normal{0.0, 0.0, 1.0};
};

/// A cell of one stroke.
using CellKey = std::tuple<std::uint32_t, std::int64_t, std::int64_t, std::int64_t>;

CellKey cell_key(std::uint32_t stroke, const Point3& point) {
  const auto cell = [](double value) { return static_cast<std::int64_t>(std::floor(value / kCell_m)); };
  return {stroke, cell(point.x()), cell(point.y()), cell(point.z())};
}

/// Points sorted by stroke and cell.
class StrokeGrid {
 public:
  StrokeGrid(const std::vector<Point3>& points, const std::vector<std::uint32_t>& strokes) : points_(points) {
    for (std::uint32_t k = 0; k < points.size(); ++k) entries_.emplace_back(cell_key(strokes[k], points[k]), k);
    std::sort(entries_.begin(), entries_.end());
  }
  /// Points of a stroke within a cell's size of the position: the nearest, the farthest and an even selection in
  /// between, because the nearest are often on one line of the scan. Fewer if there are not enough.
  [[nodiscard]] std::vector<std::uint32_t> around(std::uint32_t stroke, const Point3& place, std::size_t count) const {
    std::vector<std::pair<double, std::uint32_t>> found;
    const auto [own, x, y, z] = cell_key(stroke, place);
    for (std::int64_t i = -1; i <= 1; ++i) {
      for (std::int64_t j = -1; j <= 1; ++j) {
        // The cells z - 1 to z + 1 are consecutive.
        const CellKey first{stroke, x + i, y + j, z - 1};
        const CellKey last{stroke, x + i, y + j, z + 1};
        const auto begin = std::lower_bound(entries_.begin(), entries_.end(), std::pair(first, std::uint32_t{0}));
        for (auto entry = begin; entry != entries_.end() && entry->first <= last; ++entry) {
          const double sq_distance = (points_[entry->second] - place).squaredNorm();
          if (sq_distance <= kCell_m * kCell_m) found.emplace_back(sq_distance, entry->second);
        }
      }
    }
    std::sort(found.begin(), found.end());
    std::vector<std::uint32_t> list;
    if (found.size() < count) return list;
    for (std::size_t k = 0; k < count; ++k) list.push_back(found[k * (found.size() - 1) / (count - 1)].second);
    return list;
  }

 private:
  const std::vector<Point3>& points_;
  std::vector<std::pair<CellKey, std::uint32_t>> entries_;
};

Point3 plane_centre(const StrokePair& pair, const std::vector<Point3>& points) {
  Point3 sum = Point3::Zero();
  for (const std::uint32_t k : pair.plane) sum += points[k];
  return sum / static_cast<double>(pair.plane.size());
}

/// The plane through the neighbours.
struct Fitted {
  Point3 normal;
  bool is_flat = false;
};

Fitted fitted(const StrokePair& pair, const std::vector<Point3>& points) {
  const Point3 centre = plane_centre(pair, points);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const std::uint32_t k : pair.plane) {
    const Point3 d = points[k] - centre;
    covariance += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance / static_cast<double>(pair.plane.size()));
  const Point3& variances = eigen.eigenvalues();
  return {.normal = eigen.eigenvectors().col(0),
          .is_flat = variances(1) >= kWide_m * kWide_m && variances(0) <= kFlat * variances(1)};
}

// Distance of the point from the plane through the neighbours, along its normal, with the sign of the pair's normal. If
// the model rotates all points alike, the plane rotates with them and the miss stays.
double miss_m(const StrokePair& pair, const std::vector<Point3>& points) {
  Point3 normal = fitted(pair, points).normal;
  if (normal.dot(pair.normal) < 0.0) normal = -normal;
  return normal.dot(points[pair.point] - plane_centre(pair, points));
}

// Pairs for at most `most` evenly spread points: each needs a flat neighbourhood within `gate_m` in the next stroke.
// O(points log points).
std::vector<StrokePair> stroke_pairs(const std::vector<Point3>& points, const std::vector<std::uint32_t>& strokes,
                                     double gate_m, std::uint32_t most) {
  const StrokeGrid grid(points, strokes);
  const std::size_t step = 1 + points.size() / most;
  std::vector<StrokePair> pairs;
  for (std::size_t k = 0; k < points.size(); k += step) {
    const std::vector<std::uint32_t> near = grid.around(strokes[k] + 1, points[k], StrokePair::kNeighbours);
    if (near.size() < StrokePair::kNeighbours || (points[near.front()] - points[k]).norm() > gate_m) continue;
    StrokePair pair{.point = static_cast<std::uint32_t>(k)};
    std::copy(near.begin(), near.end(), pair.plane.begin());
    const Fitted plane = fitted(pair, points);
    if (!plane.is_flat) continue;
    pair.normal = plane.normal;
    if (std::fabs(miss_m(pair, points)) <= gate_m) pairs.push_back(pair);
  }
  return pairs;
}

double median_size(std::vector<double> values) {
  for (double& value : values) value = std::fabs(value);
  return upper_median(values);
}

/// One linearisation: misses over their standard deviation, with down-weighted outliers.
struct Linear {
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd misses;
};

class SelfCalibration {
 public:
  SelfCalibration(const SweepModel& start, const std::vector<std::uint32_t>& strokes, const StrokeAssembly& assemble,
                  const SelfCalibrationOptions& options)
      : start_{start, {}},
        strokes_(strokes),
        assemble_(assemble),
        options_(options),
        parameters_(make_parameters(start_, options.priors)),
        x_(parameters_.size(), 0.0) {}

  SelfCalibrationResult run() {
    double gate_m = options_.first_gate_m;
    const std::uint32_t last_pairing = rounds_of_pairing();
    for (result_.rounds = 0; result_.rounds < options_.max_rounds && !result_.converged; ++result_.rounds) {
      const std::vector<Point3> points = assembled(x_);
      if (result_.rounds < last_pairing) {
        pairs_ = stroke_pairs(points, strokes_, gate_m, options_.max_pairs);
        require_pairs();
      }
      const std::vector<double> misses = compute_misses(points);
      if (result_.rounds == 0) result_.median_miss_before_m = median_size(misses);
      linear_ = linearised(misses);
      const double step = take_step();
      result_.converged = result_.rounds + 1 >= last_pairing && step < kSettledShift;
      gate_m = std::max(options_.last_gate_m, 0.5 * gate_m);
    }
    return finished();
  }

 private:
  // New pairs are found until the gate has been closed twice, then kept, because the fit would follow their changes for
  // ever.
  [[nodiscard]] std::uint32_t rounds_of_pairing() const {
    std::uint32_t rounds = 2;
    for (double gate_m = options_.first_gate_m; gate_m > options_.last_gate_m; gate_m *= 0.5) ++rounds;
    return rounds;
  }

  [[nodiscard]] std::vector<Point3> assembled(const std::vector<double>& x) const {
    std::vector<Point3> points = assemble_(setup_at(start_, parameters_, x).model);
    if (points.size() == strokes_.size()) return points;
    throw InputError("self-calibration: the assembly gave " + std::to_string(points.size()) + " points, not " +
                     std::to_string(strokes_.size()));
  }

  void require_pairs() const {
    if (pairs_.size() >= kFewestPairs) return;
    throw InputError("only " + std::to_string(pairs_.size()) +
                     " points of a stroke have a flat surface of the next stroke beside them, " +
                     std::to_string(kFewestPairs) +
                     " are needed; record whole turns of the crank in a room, the robot standing or slow");
  }

  [[nodiscard]] std::vector<double> compute_misses(const std::vector<Point3>& points) const {
    std::vector<double> misses;
    for (const StrokePair& pair : pairs_) misses.push_back(miss_m(pair, points));
    return misses;
  }

  [[nodiscard]] Linear linearised(const std::vector<double>& misses) const {
    const auto rows = static_cast<Eigen::Index>(misses.size());
    Linear linear{Eigen::MatrixXd(rows, static_cast<Eigen::Index>(x_.size())), Eigen::VectorXd(rows)};
    const double sigma_m = std::max(options_.sigma_m, 1.4826 * median_size(misses));
    Eigen::VectorXd gains(rows);
    for (Eigen::Index k = 0; k < rows; ++k) {
      const double size = std::fabs(misses[static_cast<std::size_t>(k)]) / sigma_m;
      gains(k) = std::sqrt(std::min(1.0, kHuberSigmas / std::max(size, 1e-12))) / sigma_m;
      linear.misses(k) = gains(k) * misses[static_cast<std::size_t>(k)];
    }
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const std::vector<double> above = compute_misses(assembled(moved(i, kDifference)));
      const std::vector<double> below = compute_misses(assembled(moved(i, -kDifference)));
      for (Eigen::Index k = 0; k < rows; ++k) {
        const auto row = static_cast<std::size_t>(k);
        linear.jacobian(k, static_cast<Eigen::Index>(i)) = gains(k) * (above[row] - below[row]) / (2.0 * kDifference);
      }
    }
    return linear;
  }

  [[nodiscard]] std::vector<double> moved(std::size_t i, double change) const {
    std::vector<double> x = x_;
    x[i] += change;
    return x;
  }

  // Gauss-Newton with the priors, shortened until the bars are within their bounds and the loop closes. Directions that
  // neither data nor priors determine do not move (least-norm step).
  double take_step() {
    const auto count = static_cast<Eigen::Index>(x_.size());
    const Eigen::Index rows = linear_.misses.size();
    Eigen::MatrixXd stacked = Eigen::MatrixXd::Zero(rows + count, count);
    Eigen::VectorXd target = Eigen::VectorXd::Zero(rows + count);
    stacked.topRows(rows) = linear_.jacobian;
    target.head(rows) = -linear_.misses;
    for (Eigen::Index i = 0; i < count; ++i) {
      const Parameter& parameter = parameters_[static_cast<std::size_t>(i)];
      const double pull = parameter.prior_sigma > 0.0 ? parameter.scale / parameter.prior_sigma : 0.0;
      stacked(rows + i, i) = pull;
      target(rows + i) = -pull * x_[static_cast<std::size_t>(i)];
    }
    const Eigen::VectorXd step = stacked.completeOrthogonalDecomposition().solve(target);
    for (double share = 1.0; share > 1e-3; share *= 0.5) {
      std::vector<double> x = x_;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double bound = parameters_[i].bound_scaled();
        x[i] = std::clamp(x[i] + share * step(static_cast<Eigen::Index>(i)), -bound, bound);
      }
      if (closing_room_m(setup_at(start_, parameters_, x).model.bars) <= 0.0) continue;
      double largest = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) largest = std::max(largest, std::fabs(x[i] - x_[i]));
      x_ = x;
      return largest;
    }
    return 0.0;
  }

  SelfCalibrationResult finished() {
    const Setup found = setup_at(start_, parameters_, x_);
    result_.model = found.model;
    result_.model.encoder.zero_rad = wrap_angle(found.model.encoder.zero_rad);
    result_.median_miss_m = median_size(compute_misses(assembled(x_)));
    result_.pairs = static_cast<std::uint32_t>(pairs_.size());
    const Observability seen = compute_observability(linear_.jacobian, parameters_);
    result_.parameters = described(parameters_, x_, seen);
    result_.singular_values = {seen.singular_values.data(), seen.singular_values.data() + seen.singular_values.size()};
    result_.weak = weak_combinations(found, parameters_, seen);
    std::string unseen;
    for (const CalibratedParameter& parameter : result_.parameters) {
      if (parameter.data_share < 0.5) unseen += (unseen.empty() ? "" : ", ") + parameter.name;
      if (parameter.at_bound) result_.remarks.push_back(parameter.name + " lies on its bound");
    }
    if (!unseen.empty()) {
      result_.remarks.push_back("up and down strokes hardly tell " + unseen +
                                ": what moves both strokes alike stays as it was; calibrate against a wall for that");
    }
    return std::move(result_);
  }

  Setup start_;
  const std::vector<std::uint32_t>& strokes_;
  const StrokeAssembly& assemble_;
  SelfCalibrationOptions options_;
  std::vector<Parameter> parameters_;
  std::vector<double> x_;
  std::vector<StrokePair> pairs_;
  Linear linear_;
  SelfCalibrationResult result_;
};

}  // namespace

SelfCalibrationResult self_calibrate(const SweepModel& start, const std::vector<std::uint32_t>& strokes,
                                     const StrokeAssembly& assemble, const SelfCalibrationOptions& options) {
  std::vector<std::string> faults = validate(options.priors);
  for (const std::string& fault : validate(start)) faults.push_back("linkage '" + start.name + "': " + fault);
  if (!faults.empty()) throw ConfigError("self-calibration: " + faults.front());
  if (closing_room_m(start.bars) <= 0.0) {
    throw ConfigError("linkage '" + start.name +
                      "': its loop does not close all around; `gdtslam linkage` shows where");
  }
  return SelfCalibration(start, strokes, assemble, options).run();
}

std::string reason_for_distrust(const SelfCalibrationResult& result) {
  return result.converged ? "" : "the strokes did not settle within " + std::to_string(result.rounds) + " rounds";
}

}  // namespace gdtslam::calib
