#include "variance_components.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kFewestClosures = 4;
constexpr double kUsualLog = 2.3;  // standard deviation of the factor's logarithm: stated values are right within ten
constexpr std::size_t kMostClosures = 400;
constexpr double kFactorStep = 1.7782794;  // fourth root of ten
constexpr double kClosureFreedom = 4.0;    // degrees of freedom of Student's t: a few loops may be far off
constexpr double kDimensions = 3.0;

/// Difference between a loop and the chain, and the information of both.
struct Closure {
  Tangent2 off;
  Matrix3 of_chain;  // covariances
  Matrix3 of_loop;
};

/// Poses, and the sums of the steps' covariances carried to the first node's frame.
struct Chain {
  std::vector<Pose2> poses{Pose2{}};
  std::vector<Matrix3> covariances{Matrix3{}};
};

Chain chain_poses(std::span<const PoseRelation> steps) {
  Chain chain;
  for (const PoseRelation& step : steps) {
    chain.poses.push_back(chain.poses.back() * step.T_from_to);
    const Matrix3 carried = adjoint_matrix(chain.poses.back());
    chain.covariances.push_back(chain.covariances.back() +
                                carried * times_transposed(inverse(step.information), carried));
  }
  return chain;
}

Closure measure_closure(const Chain& chain, const PoseRelation& loop) {
  const Matrix3 carried = adjoint_matrix(inverse(chain.poses[loop.to]));
  Matrix3 since = chain.covariances[loop.to];
  since -= chain.covariances[loop.from];
  return {.off = log_tangent(between(loop.T_from_to, between(chain.poses[loop.from], chain.poses[loop.to]))),
          .of_chain = carried * times_transposed(since, carried),
          .of_loop = inverse(loop.information)};
}

double minus_log_likelihood(const std::vector<Closure>& closures, double factor) {
  double sum = 0.0;
  for (const Closure& c : closures) {
    const Matrix3 l = cholesky(factor * c.of_chain + c.of_loop);
    const Tangent2 white = solve_lower(l, c.off);
    sum += log(l(0, 0) * l(1, 1) * l(2, 2)) +
           0.5 * (kClosureFreedom + kDimensions) * log(1.0 + dot(white, white) / kClosureFreedom);
  }
  return sum;
}

}  // namespace

VarianceFactor variance_factor(std::span<const PoseRelation> chain, std::span<const Loop> loops) {
  std::vector<const Loop*> on;
  for (const Loop& loop : loops) {
    if (loop.is_on()) on.push_back(&loop);
  }
  VarianceFactor best;
  if (on.size() < kFewestClosures) return best;
  const Chain poses = chain_poses(chain);
  std::vector<Closure> closures;
  for (std::size_t i = 0; i < on.size(); i += on.size() / kMostClosures + 1) {
    closures.push_back(measure_closure(poses, on[i]->relation));
  }
  best.closures = closures.size();
  double least = std::numeric_limits<double>::infinity();
  for (double factor = kLeastVarianceFactor; factor <= kMostVarianceFactor; factor *= kFactorStep) {
    const double unusual = log(factor) / kUsualLog;
    const double now = minus_log_likelihood(closures, factor) + 0.5 * unusual * unusual;
    if (now >= least) continue;
    least = now;
    best.variance = best.turn_variance = factor;
  }
  return best;
}

PoseRelation rescaled(const PoseRelation& relation, const VarianceFactor& factor) {
  const double way = 1.0 / std::sqrt(factor.variance);
  const Matrix3 scale = Matrix3::diagonal(way, way, 1.0 / std::sqrt(factor.turn_variance));
  PoseRelation result = relation;
  result.information = scale * relation.information * scale;
  return result;
}

}  // namespace gdtslam
