// Describes the parameter combinations that the data leave free, in words.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "observability.hpp"

namespace gdtslam::calib {
namespace {

constexpr double kMostlyOne = 0.99;   // squared share of a direction in a space, or of one parameter
constexpr double kWorthNaming = 0.2;  // share of the largest weight
constexpr double kAliased = 0.1;      // share of an effect that the parameters cannot reproduce

// Formats with a sign; `digits` decimals, or significant digits with chars_format::general.
std::string signed_text(double value, std::chars_format format, int digits) {
  std::array<char, 48> text{};
  const std::to_chars_result end = std::to_chars(text.data(), text.data() + text.size(), value, format, digits);
  return (value < 0.0 ? "" : "+") + std::string(text.data(), end.ptr);
}

// All bars longer by the same share, which changes no angle of the loop.
Eigen::VectorXd scale_direction(Setup setup, std::span<const Parameter> parameters) {
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(eigen_index(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!is_bar(parameters[i].name)) continue;
    direction(eigen_index(i)) = parameters[i].kind->value(setup, 0) / parameters[i].scale;
  }
  return direction.normalized();
}

// "crank +0.71, ground -0.70": the parameters with a share, the first one positive.
std::string listed(const Eigen::VectorXd& weights, std::span<const Parameter> parameters) {
  const double largest = weights.cwiseAbs().maxCoeff();
  double sign = 0.0;
  std::string text;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double weight = weights(eigen_index(i));
    if (std::fabs(weight) < kWorthNaming * largest) continue;
    if (sign == 0.0) sign = weight < 0.0 ? -1.0 : 1.0;
    text +=
        (text.empty() ? "" : ", ") + parameters[i].name + " " + signed_text(sign * weight, std::chars_format::fixed, 2);
  }
  return text;
}

std::string words_for(double singular_value, const Eigen::VectorXd& weights, std::span<const Parameter> parameters) {
  Eigen::Index largest = 0;
  weights.cwiseAbs().maxCoeff(&largest);
  const std::string& name = parameters[static_cast<std::size_t>(largest)].name;
  const bool is_free = singular_value == 0.0;
  if (weights(largest) * weights(largest) > kMostlyOne) {
    return name + (is_free ? ": these ranges do not depend on it" : ": these ranges hardly depend on it");
  }
  return listed(weights, parameters) + (is_free ? " change together: no range changes" : " change together");
}

WeakCombination combination(double singular_value, const Eigen::VectorXd& weights, std::string text) {
  return {.singular_value = singular_value,
          .weights = {weights.data(), weights.data() + weights.size()},
          .text = std::move(text)};
}

// Removes a direction from a space of undetermined directions; the space shrinks by one.
void take_out(Eigen::MatrixXd& space, const Eigen::VectorXd& direction) {
  const Eigen::MatrixXd rest = space - direction * (direction.transpose() * space);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rest, Eigen::ComputeThinU);
  space = svd.matrixU().leftCols(space.cols() - 1).eval();
}

bool contains(const Eigen::MatrixXd& space, const Eigen::VectorXd& direction) {
  return space.cols() > 0 && (space.transpose() * direction).squaredNorm() > kMostlyOne;
}

// Describes the directions that no data determine. Any basis of them is valid, so directions with a name come first.
void describe_free(Eigen::MatrixXd space, const Setup& setup, std::span<const Parameter> parameters,
                   std::vector<WeakCombination>& found) {
  const Eigen::VectorXd scale = scale_direction(setup, parameters);
  if (contains(space, scale)) {
    found.push_back(combination(0.0, scale,
                                "crank, coupler, rocker and ground grow together (scale): ranges tell the ratios of "
                                "the bars; the elevation does not depend on their scale"));
    take_out(space, scale);
  }
  for (std::size_t i = 0; i < parameters.size() && space.cols() > 0; ++i) {
    const Eigen::VectorXd alone = Eigen::VectorXd::Unit(eigen_index(parameters.size()), eigen_index(i));
    if (!contains(space, alone)) continue;
    found.push_back(combination(0.0, alone, words_for(0.0, alone, parameters)));
    take_out(space, alone);
  }
  for (Eigen::Index k = 0; k < space.cols(); ++k) {
    found.push_back(combination(0.0, space.col(k), words_for(0.0, space.col(k), parameters)));
  }
}

/// An assumption of the calibration, and the parameter change that its violation would look like.
struct Assumption {
  std::string what;  ///< with its size, "a bias of the ranges of 1 mm"
  Eigen::VectorXd effect;
};

std::string shift_text(double shift, const Parameter& parameter) {
  const double value = shift * parameter.scale;
  const bool is_length = parameter.unit == "m";
  const double shown = is_length ? value * 1000.0 : deg_from_rad(value);
  return parameter.name + " " + signed_text(shown, std::chars_format::general, 2) + (is_length ? " mm" : " deg");
}

// Reports how the fit would absorb the violated assumption: the relevant shifts, and whether the misses would show it.
std::string remark_on(const Assumption& assumption, std::span<const Parameter> parameters, const Observability& seen) {
  const Eigen::VectorXd shift = -(seen.covariance * (seen.jacobian.transpose() * assumption.effect));
  const double left_over = (assumption.effect + seen.jacobian * shift).norm() / assumption.effect.norm();
  const double largest = shift.cwiseAbs().maxCoeff();
  std::string shifts;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (std::fabs(shift(eigen_index(i))) < kWorthNaming * largest) continue;
    shifts += (shifts.empty() ? "" : ", ") + shift_text(shift(eigen_index(i)), parameters[i]);
  }
  return assumption.what +
         (left_over < kAliased ? " cannot be told apart from these parameters and would be read as "
                               : " is taken for granted not to be there; it would move ") +
         shifts;
}

}  // namespace

std::vector<WeakCombination> weak_combinations(const Setup& setup, std::span<const Parameter> parameters,
                                               const Observability& seen) {
  std::vector<WeakCombination> found;
  const double nothing = kRounding * seen.singular_values.maxCoeff();
  Eigen::Index free = 0;
  for (Eigen::Index k = 0; k < seen.singular_values.size(); ++k) {
    const double value = seen.singular_values(k);
    if (value <= nothing) {
      ++free;
    } else if (value < kWeakSingularValue) {
      const Eigen::VectorXd weights = seen.combinations.col(k);
      found.push_back(combination(value, weights, words_for(value, weights, parameters)));
    }
  }
  if (free > 0) describe_free(seen.combinations.rightCols(free), setup, parameters, found);
  return found;
}

std::vector<std::string> alias_remarks(const Setup& setup, std::span<const Parameter> parameters,
                                       const Observability& seen, const Fit& fit) {
  const std::optional<Misses> misses = misses_at(setup, fit.used);
  if (!misses) return {};
  const std::size_t count = misses->list.size();
  Assumption bias{"a bias of the ranges of 1 mm", Eigen::VectorXd::Zero(eigen_index(count))};
  std::vector<Assumption> tilts;
  for (const CalibrationSurface& surface : setup.surfaces) {
    tilts.push_back(
        {surface.name + (surface.kind == SurfaceKind::kWall ? " leaning by 0.1 deg" : " sloping by 0.1 deg"),
         Eigen::VectorXd::Zero(eigen_index(count))});
  }
  for (std::size_t row = 0; row < count; ++row) {
    const double gain = seen.gains(eigen_index(row));  // the weight of the misses
    bias.effect(eigen_index(row)) = gain * 0.001 * misses->list[row].incidence;
    tilts[fit.used[row].observation.surface].effect(eigen_index(row)) =
        gain * rad_from_deg(0.1) * misses->list[row].by_tilt;
  }
  std::vector<std::string> remarks{remark_on(bias, parameters, seen)};
  for (const Assumption& tilt : tilts) {
    if (tilt.effect.squaredNorm() > 0.0) remarks.push_back(remark_on(tilt, parameters, seen));
  }
  return remarks;
}

}  // namespace gdtslam::calib
