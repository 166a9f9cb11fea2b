#include "fit.hpp"

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>
#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <set>

#include "engine/core/quantile.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::calib {
namespace {

constexpr double kLeastIncidence = 0.05;  // beams flatter than 3 degrees on the surface count as 3 degrees
constexpr int kWeighings = 6;         // limit, because an observation at the elevation limit could alternate for ever
constexpr double kSettled = 1e-5;     // relative to a step of 1: one prior's sigma
constexpr double kBoundSlack = 1e-9;  // share of a bound
constexpr std::size_t kSparePerParameter = 2;

/// The setup at the current parameters, computed once for all misses.
class SetupInHand final : public ceres::EvaluationCallback {
 public:
  SetupInHand(const Setup& start, std::span<const Parameter> parameters) : start_(start), parameters_(parameters) {}
  void watch(const std::vector<double>& x) { x_ = &x; }
  void PrepareForEvaluation(bool /*evaluate_jacobians*/, bool is_new_point) override {
    if (!is_new_point) return;
    setup = setup_at(start_, parameters_, *x_);
    closes = closing_room_m(setup.model.bars) > 0.0;
  }

  Setup setup;
  bool closes = false;

 private:
  const Setup& start_;
  std::span<const Parameter> parameters_;
  const std::vector<double>* x_ = nullptr;
};

/// The miss of one observation in standard deviations.
class MissCost final : public ceres::CostFunction {
 public:
  MissCost(const SetupInHand& in_hand, std::span<const Parameter> parameters, const WeightedObservation& observation)
      : in_hand_(in_hand), parameters_(parameters), observation_(observation) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(parameters.size()));
  }
  // False if the loop does not close all around: the solver takes a smaller step.
  bool Evaluate(double const* const* /*x*/, double* residual, double** jacobian) const override {
    if (!in_hand_.closes) return false;
    const RangeObservation& seen = observation_.observation;
    const std::optional<SurfaceMiss> miss =
        surface_miss(in_hand_.setup.model, in_hand_.setup.surfaces[seen.surface], seen);
    if (!miss) return false;
    residual[0] = observation_.gain * miss->miss_m;
    if (jacobian == nullptr || jacobian[0] == nullptr) return true;
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      jacobian[0][i] = observation_.gain * derivative(*miss, parameters_[i], seen.surface);
    }
    return true;
  }

 private:
  const SetupInHand& in_hand_;
  std::span<const Parameter> parameters_;
  const WeightedObservation& observation_;
};

/// Deviation of the parameters from their priors, in standard deviations.
class PriorCost final : public ceres::CostFunction {
 public:
  explicit PriorCost(std::span<const Parameter> parameters) : parameters_(parameters) {
    set_num_residuals(static_cast<int>(parameters.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(parameters.size()));
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobian) const override {
    const std::size_t count = parameters_.size();
    const bool wants_jacobian = jacobian != nullptr && jacobian[0] != nullptr;
    if (wants_jacobian) std::fill_n(jacobian[0], count * count, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
      const double pull = parameters_[i].prior_sigma > 0.0 ? parameters_[i].scale / parameters_[i].prior_sigma : 0.0;
      residuals[i] = pull * x[0][i];
      if (wants_jacobian) jacobian[0][i * count + i] = pull;
    }
    return true;
  }

 private:
  std::span<const Parameter> parameters_;
};

// Selects the observations within the elevation limit, judged by the measured ranges, with their weights.
std::vector<WeightedObservation> weigh(const Setup& setup, std::span<const RangeObservation> observations,
                                       const CalibrationOptions& options) {
  std::vector<WeightedObservation> used;
  for (const RangeObservation& observation : observations) {
    const CalibrationSurface& surface = setup.surfaces[observation.surface];
    const std::optional<double> modelled =
        elevation_rad(setup.model, crank_rad(setup.model.encoder, observation.ticks));
    if (!modelled) continue;
    const double measured = measured_elevation_rad(setup.model.mount, surface, observation, *modelled);
    if (std::fabs(measured) > options.max_elevation_rad) continue;
    const double incidence = surface_incidence(setup.model.mount, surface, measured, observation.bearing_rad);
    if (incidence <= 0.0) continue;
    used.push_back({observation, 1.0 / (observation.sigma_m * std::max(incidence, kLeastIncidence))});
  }
  return used;
}

void require_enough(std::size_t used, std::size_t given, std::size_t parameters, const CalibrationOptions& options) {
  const std::size_t needed = kSparePerParameter * parameters;
  if (used >= needed) return;
  throw InputError(std::to_string(used) + " of " + std::to_string(given) + " ranges lie within " +
                   std::to_string(static_cast<int>(std::lround(options.max_elevation_rad * 57.29577951308232))) +
                   " deg of elevation, and " + std::to_string(parameters) + " parameters need at least " +
                   std::to_string(needed) + "; let the crank stop more often, or check the start and the surfaces");
}

// 1.4826 times the median of the absolute values: their standard deviation if they are normal.
double robust_spread(std::vector<double> values) {
  for (double& value : values) value = std::fabs(value);
  return 1.4826 * upper_median(values);
}

ceres::Solver::Options solver_options() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.max_num_iterations = 100;
  options.max_num_consecutive_invalid_steps = 20;  // steps after which the loop does not close
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-10;
  options.gradient_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  return options;
}

/// Ends the solver before its next step if the caller requests a stop.
class StopAsked final : public ceres::IterationCallback {
 public:
  explicit StopAsked(const std::function<bool()>& stop) : stop_(stop) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*step*/) override {
    return is_over() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }
  void expect_none() const {
    if (is_over()) throw Error(ExitCode::kInterrupted, "interrupted while calibrating; nothing was written");
  }

 private:
  [[nodiscard]] bool is_over() const { return stop_ && stop_(); }
  const std::function<bool()>& stop_;
};

/// The fit with fixed weights. An active set enforces the bounds: with misses as curved as here, the solver's own
/// projection onto a box creeps along a bound.
class WeightedFit {
 public:
  WeightedFit(const Setup& start, std::span<const Parameter> parameters, const std::vector<WeightedObservation>& used,
              double huber, const std::function<bool()>& stop)
      : start_(start),
        parameters_(parameters),
        in_hand_(start, parameters),
        loss_(huber),
        prior_(parameters),
        stop_(stop) {
    for (const WeightedObservation& observation : used) costs_.emplace_back(in_hand_, parameters, observation);
  }

  /// Changes x, which stays within the bounds.
  void solve(std::vector<double>& x) {
    std::set<int> held;
    std::set<int> released;
    for (std::size_t turn = 0; turn < 3 * parameters_.size(); ++turn) {
      std::vector<double> trial = x;
      solve_free(trial, held);
      if (const std::optional<int> outside = farthest_outside(trial)) {
        held.insert(*outside);
        x = moved_within(trial, x);
        continue;
      }
      x = trial;
      const std::optional<int> pulled = pulled_inside(x, held, released);
      if (!pulled) return;
      held.erase(*pulled);
      released.insert(*pulled);
    }
  }

  int iterations = 0;
  double cost = 0.0;
  bool converged = false;
  std::string reason;

 private:
  void build(ceres::Problem& problem, std::vector<double>& x) {
    problem.AddParameterBlock(x.data(), static_cast<int>(x.size()));
    for (MissCost& miss : costs_) problem.AddResidualBlock(&miss, &loss_, x.data());
    problem.AddResidualBlock(&prior_, nullptr, x.data());
  }

  void solve_free(std::vector<double>& x, const std::set<int>& held) {
    ceres::Problem problem(problem_options(x));
    build(problem, x);
    ceres::SubsetManifold manifold(static_cast<int>(x.size()), {held.begin(), held.end()});
    if (!held.empty()) problem.SetManifold(x.data(), &manifold);
    ceres::Solver::Summary summary;
    ceres::Solver::Options options = solver_options();
    options.callbacks.push_back(&stop_);
    ceres::Solve(options, &problem, &summary);
    stop_.expect_none();
    iterations += static_cast<int>(summary.iterations.size());
    cost = summary.final_cost;
    converged = summary.termination_type == ceres::CONVERGENCE;
    reason = summary.message;
  }

  [[nodiscard]] std::optional<int> farthest_outside(const std::vector<double>& x) const {
    double farthest = 1.0 + kBoundSlack;
    std::optional<int> outside;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double share = std::fabs(x[i]) / parameters_[i].bound_scaled();
      if (share <= farthest) continue;
      farthest = share;
      outside = static_cast<int>(i);
    }
    return outside;
  }

  /// The trial clamped to the bounds, or moved back towards x until the loop closes.
  [[nodiscard]] std::vector<double> moved_within(const std::vector<double>& trial, const std::vector<double>& x) const {
    for (double share = 1.0; share > kBoundSlack; share *= 0.5) {
      std::vector<double> within = x;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double bound = parameters_[i].bound_scaled();
        within[i] = std::clamp(x[i] + share * (trial[i] - x[i]), -bound, bound);
      }
      if (closing_room_m(setup_at(start_, parameters_, within).model.bars) > 0.0) return within;
    }
    return x;
  }

  /// A parameter held at its bound although the cost falls towards the inside.
  std::optional<int> pulled_inside(std::vector<double>& x, const std::set<int>& held, const std::set<int>& released) {
    if (held.empty()) return std::nullopt;
    ceres::Problem problem(problem_options(x));
    build(problem, x);
    std::vector<double> gradient;
    double cost_here = 0.0;
    if (!problem.Evaluate({}, &cost_here, nullptr, &gradient, nullptr)) return std::nullopt;
    for (const int i : held) {
      const auto k = static_cast<std::size_t>(i);
      if (released.count(i) == 0 && gradient[k] * x[k] > 0.0) return i;
    }
    return std::nullopt;
  }

  ceres::Problem::Options problem_options(const std::vector<double>& x) {
    in_hand_.watch(x);
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.evaluation_callback = &in_hand_;
    return options;
  }

  const Setup& start_;
  std::span<const Parameter> parameters_;
  SetupInHand in_hand_;
  ceres::HuberLoss loss_;
  PriorCost prior_;
  StopAsked stop_;
  std::deque<MissCost> costs_;
};

double largest_change(const std::vector<double>& a, const std::vector<double>& b) {
  double change = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) change = std::max(change, std::fabs(a[i] - b[i]));
  return change;
}

// Count of outliers and the spread of the others.
void judge(const Misses& misses, const CalibrationOptions& options, Fit& fit) {
  double sum = 0.0;
  double sum_of_all = 0.0;
  std::uint64_t inliers = 0;
  for (const double miss : misses.weighted) {
    sum_of_all += miss * miss;
    if (std::fabs(miss) > options.huber_sigmas) continue;
    sum += miss * miss;
    ++inliers;
  }
  fit.all_rms = std::sqrt(sum_of_all / static_cast<double>(std::max<std::size_t>(1, misses.weighted.size())));
  fit.outliers = misses.weighted.size() - inliers;
  fit.rms = inliers > 0 ? std::sqrt(sum / static_cast<double>(inliers)) : std::numeric_limits<double>::infinity();
}

}  // namespace

std::optional<Misses> misses_at(const Setup& setup, std::span<const WeightedObservation> observations) {
  Misses misses;
  if (closing_room_m(setup.model.bars) <= 0.0) return std::nullopt;
  for (const auto& [observation, gain] : observations) {
    const std::optional<SurfaceMiss> miss = surface_miss(setup.model, setup.surfaces[observation.surface], observation);
    if (!miss) return std::nullopt;
    misses.list.push_back(*miss);
    misses.weighted.push_back(gain * miss->miss_m);
  }
  return misses;
}

// The loss starts as wide as the misses and narrows to the requested width: a start some degrees off has misses of
// hundreds of sigmas, and a narrow loss would treat all of them as outliers.
Fit fit(const Setup& start, std::span<const Parameter> parameters, std::span<const RangeObservation> observations,
        const CalibrationOptions& options, int rounds) {
  Fit result;
  result.x.assign(parameters.size(), 0.0);
  for (int round = 0; round < rounds; ++round) {
    const Setup setup = setup_at(start, parameters, result.x);
    if (round < kWeighings) result.used = weigh(setup, observations, options);
    require_enough(result.used.size(), observations.size(), parameters.size(), options);
    const std::optional<Misses> before = misses_at(setup, result.used);
    if (!before) break;
    const double spread = std::max(1.0, robust_spread(before->weighted));
    const std::vector<double> last = result.x;
    WeightedFit weighted(start, parameters, result.used, options.huber_sigmas * spread, options.stop);
    weighted.solve(result.x);
    result.iterations += weighted.iterations;
    result.cost = weighted.cost / static_cast<double>(result.used.size());
    result.converged = weighted.converged;
    result.reason = weighted.reason;
    if (largest_change(last, result.x) < kSettled) break;
    result.converged = false;  // except for the next round
    result.reason = "the parameters still move after " + std::to_string(round + 1) + " rounds of weighing";
  }
  const std::optional<Misses> after = misses_at(setup_at(start, parameters, result.x), result.used);
  if (!after) {
    result.converged = false;
    result.rms = result.all_rms = std::numeric_limits<double>::infinity();
    return result;
  }
  judge(*after, options, result);
  return result;
}

}  // namespace gdtslam::calib
