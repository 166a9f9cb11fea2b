#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "observability.hpp"
#include "self_calibration.hpp"
#include "stroke_pairs.hpp"

namespace gdtslam::calib {
namespace {

constexpr double kDifference = 0.002;  // of a scaled parameter: 6 micrometres of a bar, 0.004 deg of the zero
constexpr double kSettled = 0.05;      // largest step, in prior sigmas; below it the pairs change as much
constexpr std::size_t kFewestPairs = 100;
constexpr double kHuberSigmas = 1.5;

double median_of(std::vector<double> values) {
  for (double& value : values) value = std::fabs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// One linearisation: misses over their standard deviation, weighed down where they are outliers.
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
        parameters_(parameters_of(start_, options.priors)),
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
      const std::vector<double> misses = misses_of(points);
      if (result_.rounds == 0) result_.median_miss_before_m = median_of(misses);
      linear_ = linearised(misses);
      const double step = take_step();
      result_.converged = result_.rounds + 1 >= last_pairing && step < kSettled;
      gate_m = std::max(options_.last_gate_m, 0.5 * gate_m);
    }
    return finished();
  }

 private:
  // Pairs are found anew until the gate has been closed twice, then kept: else the fit would follow their changes for
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

  [[nodiscard]] std::vector<double> misses_of(const std::vector<Point3>& points) const {
    std::vector<double> misses;
    for (const StrokePair& pair : pairs_) misses.push_back(miss_m(pair, points));
    return misses;
  }

  [[nodiscard]] Linear linearised(const std::vector<double>& misses) const {
    const auto rows = static_cast<Eigen::Index>(misses.size());
    Linear linear{Eigen::MatrixXd(rows, static_cast<Eigen::Index>(x_.size())), Eigen::VectorXd(rows)};
    const double sigma_m = std::max(options_.sigma_m, 1.4826 * median_of(misses));
    Eigen::VectorXd gains(rows);
    for (Eigen::Index k = 0; k < rows; ++k) {
      const double size = std::fabs(misses[static_cast<std::size_t>(k)]) / sigma_m;
      gains(k) = std::sqrt(std::min(1.0, kHuberSigmas / std::max(size, 1e-12))) / sigma_m;
      linear.misses(k) = gains(k) * misses[static_cast<std::size_t>(k)];
    }
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const std::vector<double> above = misses_of(assembled(moved(i, kDifference)));
      const std::vector<double> below = misses_of(assembled(moved(i, -kDifference)));
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

  // Gauss-Newton with the priors, shortened until the bars stay within their bounds and the loop closes. What neither
  // data nor priors hold stays where it is (the least-norm step).
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
    result_.median_miss_m = median_of(misses_of(assembled(x_)));
    result_.pairs = static_cast<std::uint32_t>(pairs_.size());
    const Observability seen = observability_of(linear_.jacobian, parameters_);
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

}  // namespace gdtslam::calib
