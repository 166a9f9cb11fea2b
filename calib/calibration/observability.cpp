#include "observability.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace gdtslam::calib {
namespace {

constexpr double kAtBound = 1e-6;  // share of the bound
// A parameter with a smaller squared share of an undetermined combination does not move with it.
constexpr double kLeastShare = 1e-12;

// Derivative of the Huber loss: the weight of an outlier.
double robust_weight(double miss, double huber_sigmas) {
  const double size = std::fabs(miss);
  return size <= huber_sigmas ? 1.0 : huber_sigmas / size;
}

Misses required_misses(const Setup& setup, const Fit& fit) {
  std::optional<Misses> misses = misses_at(setup, fit.used);
  return misses ? std::move(*misses) : Misses{};
}

// The weight of each row; outliers have less.
Eigen::VectorXd row_gains(const Misses& misses, const Fit& fit, double huber_sigmas) {
  Eigen::VectorXd gains(eigen_index(misses.list.size()));
  for (std::size_t row = 0; row < misses.list.size(); ++row) {
    gains(eigen_index(row)) = fit.used[row].gain * std::sqrt(robust_weight(misses.weighted[row], huber_sigmas));
  }
  return gains;
}

Eigen::MatrixXd weighted_jacobian(const Misses& misses, std::span<const Parameter> parameters, const Fit& fit,
                                  const Eigen::VectorXd& gains) {
  Eigen::MatrixXd jacobian(eigen_index(misses.list.size()), eigen_index(parameters.size()));
  for (std::size_t row = 0; row < misses.list.size(); ++row) {
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      jacobian(eigen_index(row), eigen_index(i)) =
          gains(eigen_index(row)) * derivative(misses.list[row], parameters[i], fit.used[row].observation.surface);
    }
  }
  return jacobian;
}

// The Jacobian with a row for each prior below it.
Eigen::MatrixXd with_priors(const Eigen::MatrixXd& jacobian, std::span<const Parameter> parameters) {
  Eigen::MatrixXd stacked = Eigen::MatrixXd::Zero(jacobian.rows() + jacobian.cols(), jacobian.cols());
  stacked.topRows(jacobian.rows()) = jacobian;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double sigma = parameters[i].prior_sigma;
    stacked(jacobian.rows() + eigen_index(i), eigen_index(i)) = sigma > 0.0 ? parameters[i].scale / sigma : 0.0;
  }
  return stacked;
}

/// Singular values, right singular vectors and the resulting sigmas of the parameters.
struct Spectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
  Eigen::VectorXd sigma;  ///< infinite for parameters in an undetermined direction
  Eigen::MatrixXd covariance;
};

Spectrum compute_spectrum(const Eigen::MatrixXd& jacobian) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeThinV);
  Spectrum spectrum;
  spectrum.values = svd.singularValues();
  spectrum.vectors = svd.matrixV();
  const Eigen::Index count = spectrum.values.size();
  const double least = kRounding * spectrum.values.maxCoeff();
  Eigen::VectorXd unheld = Eigen::VectorXd::Zero(count);
  spectrum.covariance = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd direction = spectrum.vectors.col(k);
    if (spectrum.values(k) > least) {
      spectrum.covariance += direction * direction.transpose() / (spectrum.values(k) * spectrum.values(k));
    } else {
      unheld += direction.cwiseAbs2();
    }
  }
  spectrum.sigma = spectrum.covariance.diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < count; ++i) {
    if (unheld(i) > kLeastShare) spectrum.sigma(i) = kInfinity;
  }
  return spectrum;
}

}  // namespace

Observability compute_observability(const Eigen::MatrixXd& jacobian, std::span<const Parameter> parameters) {
  Observability seen;
  seen.jacobian = jacobian;
  const Spectrum data = compute_spectrum(jacobian);
  seen.singular_values = data.values;
  seen.combinations = data.vectors;
  seen.data_sigma = data.sigma;
  const Spectrum posterior = compute_spectrum(with_priors(jacobian, parameters));
  seen.sigma = posterior.sigma;
  seen.covariance = posterior.covariance;
  return seen;
}

std::vector<CalibratedParameter> described(std::span<const Parameter> parameters, std::span<const double> x,
                                           const Observability& seen) {
  std::vector<CalibratedParameter> list;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& parameter = parameters[i];
    const double sigma = seen.sigma(eigen_index(i));
    list.push_back({.name = parameter.name,
                    .unit = parameter.unit,
                    .start = parameter.start,
                    .estimate = parameter.start + parameter.scale * x[i],
                    .sigma = sigma * parameter.scale,
                    .data_share = std::clamp(1.0 - sigma * sigma, 0.0, 1.0),
                    .at_bound = std::fabs(x[i]) >= parameter.bound_scaled() * (1.0 - kAtBound),
                    .observable = seen.data_sigma(eigen_index(i)) <= 1.0 / kWeakSingularValue});
  }
  return list;
}

Observability observe(const Setup& setup, std::span<const Parameter> parameters, const Fit& fit, double huber_sigmas) {
  const Misses misses = required_misses(setup, fit);
  const Eigen::VectorXd gains = row_gains(misses, fit, huber_sigmas);
  Observability seen = compute_observability(weighted_jacobian(misses, parameters, fit, gains), parameters);
  seen.gains = gains;
  return seen;
}

double elevation_sigma_rad(const Setup& setup, std::span<const Parameter> parameters, const Observability& seen,
                           const Fit& fit) {
  const Misses misses = required_misses(setup, fit);
  double sum = 0.0;
  Eigen::VectorXd gradient(eigen_index(parameters.size()));
  for (const SurfaceMiss& miss : misses.list) {
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      gradient(eigen_index(i)) = elevation_derivative(miss, parameters[i]);
    }
    sum += gradient.dot(seen.covariance * gradient);
  }
  return misses.list.empty() ? kInfinity : std::sqrt(std::max(0.0, sum / static_cast<double>(misses.list.size())));
}

}  // namespace gdtslam::calib
