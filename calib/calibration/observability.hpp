// Observability of each parameter, and the combinations that the data leave free: singular values of the Jacobian
// scaled by the priors [GolubVanLoan2013], without rows for the priors. A singular value is the prior's sigma over the
// data's.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "fit.hpp"

namespace gdtslam::calib {

/// A combination is weak if the data determine it worse than this share of its prior.
inline constexpr double kWeakSingularValue = 2.0;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Singular values below this share of the largest are rounding errors.
inline constexpr double kRounding = 1e-9;

/// Converts to Eigen's index type.
inline Eigen::Index eigen_index(std::size_t k) { return static_cast<Eigen::Index>(k); }

struct Observability {
  Eigen::MatrixXd jacobian;         ///< weighted, outliers down-weighted, scaled parameters
  Eigen::VectorXd gains;            ///< weights of its rows; empty if the Jacobian was passed in
  Eigen::VectorXd singular_values;  ///< descending, one per parameter
  Eigen::MatrixXd combinations;     ///< columns: right singular vectors
  Eigen::VectorXd data_sigma;       ///< sigma of scaled parameters from the data alone; infinite without dependence
  Eigen::VectorXd sigma;            ///< posterior; infinite likewise
  Eigen::MatrixXd covariance;       ///< posterior, of the determined directions
};

/// Computes it from a weighted Jacobian of scaled parameters.
Observability compute_observability(const Eigen::MatrixXd& jacobian, std::span<const Parameter> parameters);
/// The result for each parameter at x.
std::vector<CalibratedParameter> described(std::span<const Parameter> parameters, std::span<const double> x,
                                           const Observability& seen);
Observability observe(const Setup& setup, std::span<const Parameter> parameters, const Fit& fit, double huber_sigmas);
std::vector<WeakCombination> weak_combinations(const Setup& setup, std::span<const Parameter> parameters,
                                               const Observability& seen);
/// Remarks on assumptions whose violation looks like a parameter: a bias of the ranges, a leaning wall.
std::vector<std::string> alias_remarks(const Setup& setup, std::span<const Parameter> parameters,
                                       const Observability& seen, const Fit& fit);
/// RMS of the elevation's posterior sigma over the observations used, radians.
double elevation_sigma_rad(const Setup& setup, std::span<const Parameter> parameters, const Observability& seen,
                           const Fit& fit);

}  // namespace gdtslam::calib
