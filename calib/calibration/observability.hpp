// What the data tell about each parameter, and which combinations they leave free: singular values of the Jacobian
// scaled by the priors [GolubVanLoan2013], priors left out. A singular value is the prior's sigma over the data's.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "fit.hpp"

namespace gdtslam::calib {

/// Where the data tell a combination worse than this share of its prior, it counts as weak.
inline constexpr double kWeakSingularValue = 2.0;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Below this share of the largest a singular value is rounding.
inline constexpr double kRounding = 1e-9;

/// An index as Eigen has it.
inline Eigen::Index eigen_index(std::size_t k) { return static_cast<Eigen::Index>(k); }

struct Observability {
  Eigen::MatrixXd jacobian;         ///< weighted, outliers weighed down, scaled parameters
  Eigen::VectorXd gains;            ///< what its rows were weighted by; nothing where it was given
  Eigen::VectorXd singular_values;  ///< falling, one per parameter
  Eigen::MatrixXd combinations;     ///< columns: right singular vectors
  Eigen::VectorXd data_sigma;       ///< of scaled parameters from the data alone; infinite where they say nothing
  Eigen::VectorXd sigma;            ///< posterior, likewise
  Eigen::MatrixXd covariance;       ///< posterior, of the directions that something holds
};

/// From a weighted Jacobian of scaled parameters.
Observability observability_of(const Eigen::MatrixXd& jacobian, std::span<const Parameter> parameters);
/// What a result states of each parameter at x.
std::vector<CalibratedParameter> described(std::span<const Parameter> parameters, std::span<const double> x,
                                           const Observability& seen);
Observability observe(const Setup& setup, std::span<const Parameter> parameters, const Fit& fit, double huber_sigmas);
std::vector<WeakCombination> weak_combinations(const Setup& setup, std::span<const Parameter> parameters,
                                               const Observability& seen);
/// What is taken for granted and would be read as something else: a bias of the ranges, a wall that leans.
std::vector<std::string> alias_remarks(const Setup& setup, std::span<const Parameter> parameters,
                                       const Observability& seen, const Fit& fit);
/// RMS of the elevation's posterior sigma over the observations used, radians.
double elevation_sigma_rad(const Setup& setup, std::span<const Parameter> parameters, const Observability& seen,
                           const Fit& fit);

}  // namespace gdtslam::calib
