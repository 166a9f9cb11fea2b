// What data tell of parameters, from Jacobians whose spectrum is known: each column holds one parameter and no other,
// but for the directions that a test says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <vector>

#include "calib/calibration/observability.hpp"

namespace gdtslam::calib {
namespace {

using testing::HasSubstr;

class ObservabilityTest : public testing::Test {
 protected:
  ObservabilityTest() : parameters_(make_parameters(setup_, {})) {}

  [[nodiscard]] Eigen::Index at(const std::string& name) const {
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      if (parameters_[i].name == name) return eigen_index(i);
    }
    ADD_FAILURE() << "no parameter " << name;
    return 0;
  }
  [[nodiscard]] Eigen::VectorXd unit(const std::string& name) const {
    return Eigen::VectorXd::Unit(eigen_index(parameters_.size()), at(name));
  }
  /// Holds everything with 100, and each of these directions, which are at right angles, with its own value.
  [[nodiscard]] Eigen::MatrixXd holding(const std::vector<std::pair<Eigen::VectorXd, double>>& directions) const {
    const Eigen::Index n = eigen_index(parameters_.size());
    Eigen::MatrixXd square = 1.0e4 * Eigen::MatrixXd::Identity(n, n);
    for (const auto& [direction, value] : directions) {
      square += (value * value - 1.0e4) * direction * direction.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(square);
    const Eigen::VectorXd roots = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    return roots.asDiagonal() * solver.eigenvectors().transpose();
  }
  [[nodiscard]] std::vector<WeakCombination> weak(
      const std::vector<std::pair<Eigen::VectorXd, double>>& directions) const {
    // What rounding leaves of a zero is no singular value.
    Observability seen = compute_observability(holding(directions), parameters_);
    return weak_combinations(setup_, parameters_, seen);
  }
  [[nodiscard]] Eigen::VectorXd together(const std::string& a, const std::string& b, double sign) const {
    return (unit(a) + sign * unit(b)) / std::sqrt(2.0);
  }

  calib::Setup setup_{sweep_model_of_preset("paper-b"), {{.name = "wall", .distance_m = 2.0}}};
  std::vector<Parameter> parameters_;
};

TEST_F(ObservabilityTest, WhatIsHeldIsNotWeak) {
  EXPECT_TRUE(weak({}).empty());
  EXPECT_TRUE(weak({{unit("offset"), 2.001}}).empty());
  const std::vector<WeakCombination> found = weak({{unit("offset"), 1.999}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].text, "offset: these ranges hardly depend on it");
  EXPECT_NEAR(found[0].singular_value, 1.999, 1e-6);
  EXPECT_NEAR(std::fabs(found[0].weights[static_cast<std::size_t>(at("offset"))]), 1.0, 1e-9);
}

TEST_F(ObservabilityTest, NamesWhatChangesTogetherWithTheFirstOnePositive) {
  EXPECT_EQ(weak({{together("zero", "offset", 1.0), 1.0}}).at(0).text, "zero +0.71, offset +0.71 change together");
  EXPECT_EQ(weak({{together("zero", "offset", -1.0), 1.0}}).at(0).text, "zero +0.71, offset -0.71 change together");
  // A weight of less than a fifth of the largest is not named, and one alone is one whose square is above 0.99.
  const auto mostly = [&](double small) {
    const double large = std::sqrt(1.0 - small * small);
    return weak({{large * unit("zero") + small * unit("offset"), 1.0}}).at(0).text;
  };
  EXPECT_EQ(mostly(0.09), "zero: these ranges hardly depend on it");
  EXPECT_EQ(mostly(0.15), "zero +0.99 change together");
  EXPECT_EQ(mostly(0.25), "zero +0.97, offset +0.25 change together");
}

// A square root of what rounding leaves of zero is above what counts as rounding, so these hold exactly nothing.
class FreeDirections : public ObservabilityTest {
 protected:
  [[nodiscard]] std::vector<WeakCombination> free(const std::vector<Eigen::VectorXd>& directions) const {
    const Eigen::Index n = eigen_index(parameters_.size());
    Eigen::MatrixXd jacobian = 100.0 * Eigen::MatrixXd::Identity(n, n);
    for (const Eigen::VectorXd& direction : directions) {
      jacobian -= (jacobian * direction) * direction.transpose();
    }
    return weak_combinations(setup_, parameters_, compute_observability(jacobian, parameters_));
  }
  [[nodiscard]] Eigen::VectorXd scale() const {
    const FourBar& bars = setup_.model.bars;
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(eigen_index(parameters_.size()));
    const std::vector<std::pair<const char*, double>> lengths{
        {"crank", bars.crank_m}, {"coupler", bars.coupler_m}, {"rocker", bars.rocker_m}, {"ground", bars.ground_m}};
    for (const auto& [name, length_m] : lengths) {
      direction(at(name)) = length_m / parameters_[static_cast<std::size_t>(at(name))].scale;
    }
    return direction.normalized();
  }
};

TEST_F(FreeDirections, AreNamedAsTheyAre) {
  EXPECT_EQ(free({unit("zero")}).at(0).text, "zero: these ranges do not depend on it");
  EXPECT_EQ(free({unit("zero")}).at(0).singular_value, 0.0);
  const std::vector<WeakCombination> both = free({unit("zero"), unit("offset")});
  ASSERT_EQ(both.size(), 2U) << "whatever basis of the two comes out";
  EXPECT_EQ(both[0].text, "zero: these ranges do not depend on it");
  EXPECT_EQ(both[1].text, "offset: these ranges do not depend on it");
  EXPECT_EQ(free({together("zero", "offset", -1.0)}).at(0).text,
            "zero +0.71, offset -0.71 change together: no range changes");
}

TEST_F(FreeDirections, TheScaleOfTheBarsComesFirst) {
  const std::vector<WeakCombination> found = free({unit("offset"), scale()});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_THAT(found[0].text, HasSubstr("grow together (scale)"));
  for (Eigen::Index i = 0; i < scale().size(); ++i) {
    EXPECT_NEAR(found[0].weights[static_cast<std::size_t>(i)], scale()(i), 1e-9);
  }
  EXPECT_EQ(found[1].text, "offset: these ranges do not depend on it");
  EXPECT_THAT(free({unit("crank")}).at(0).text, HasSubstr("crank: these ranges do not depend on it"));
}

// A column of length 2 beside a prior of 1: the sum of squares 5 is one over the variance.
TEST_F(ObservabilityTest, SigmasAreThoseOfDataAndPriors) {
  const Eigen::Index n = eigen_index(parameters_.size());
  for (Parameter& parameter : parameters_) parameter.prior_sigma = parameter.scale;
  parameters_[1].prior_sigma = 0.0;
  parameters_[2].prior_sigma = 2.0 * parameters_[2].scale;
  Eigen::MatrixXd jacobian = 2.0 * Eigen::MatrixXd::Identity(n, n);
  jacobian(3, 3) = 0.0;
  const Observability seen = compute_observability(jacobian, parameters_);
  EXPECT_NEAR(seen.data_sigma(0), 0.5, 1e-12);
  EXPECT_NEAR(seen.sigma(0), 1.0 / std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(seen.sigma(1), 0.5, 1e-12) << "without a prior";
  EXPECT_NEAR(seen.sigma(2), 1.0 / std::sqrt(4.25), 1e-12);
  EXPECT_TRUE(std::isinf(seen.data_sigma(3)));
  EXPECT_NEAR(seen.sigma(3), 1.0, 1e-12) << "the prior alone";
  EXPECT_NEAR(seen.covariance(0, 0), 0.2, 1e-12);
  std::vector<double> x(parameters_.size(), 0.5);
  x[1] = -parameters_[1].bound_scaled();
  x[2] = parameters_[2].bound_scaled() * (1.0 - 2e-6);
  const std::vector<CalibratedParameter> told = described(parameters_, x, seen);
  EXPECT_NEAR(told[0].estimate, parameters_[0].start + 0.5 * parameters_[0].scale, 1e-12);
  EXPECT_NEAR(told[0].sigma, parameters_[0].scale / std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(told[0].data_share, 0.8, 1e-12);
  EXPECT_NEAR(told[3].data_share, 0.0, 1e-12);
  EXPECT_FALSE(told[0].at_bound);
  EXPECT_TRUE(told[1].at_bound) << "the lower one";
  EXPECT_FALSE(told[2].at_bound) << "a hair within it";
  EXPECT_TRUE(told[0].observable) << "half a prior is just enough";
  EXPECT_FALSE(told[3].observable);
  jacobian(0, 0) = 1.99;
  EXPECT_FALSE(described(parameters_, x, compute_observability(jacobian, parameters_))[0].observable);
}

}  // namespace
}  // namespace gdtslam::calib
