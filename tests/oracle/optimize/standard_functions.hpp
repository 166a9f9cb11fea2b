// Functions with known minima that optimizers are judged by, with the boxes of their sources.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "engine/optimize/minimise.hpp"

namespace gdtslam::optimize {

struct StandardFunction {
  std::string name;
  std::size_t dimensions = 2;
  double least = 0.0;  ///< of the box, in every dimension
  double most = 0.0;
  double minimum = 0.0;
  std::function<double(const double*)> value;

  [[nodiscard]] Box box() const { return {std::vector(dimensions, least), std::vector(dimensions, most)}; }
};

/// [Rosenbrock1960]: a bent valley, minimum 0 at (1, 1).
inline StandardFunction rosenbrock() {
  return {"Rosenbrock", 2, -5.0, 5.0, 0.0, [](const double* x) {
            const double a = x[1] - x[0] * x[0];
            const double b = 1.0 - x[0];
            return 100.0 * a * a + b * b;
          }};
}

/// Rastrigin's in two dimensions: 121 minima in the box, the least 0 at the origin.
inline StandardFunction rastrigin() {
  return {"Rastrigin", 2, -5.12, 5.12, 0.0, [](const double* x) {
            double sum = 20.0;
            for (std::size_t k = 0; k < 2; ++k) sum += x[k] * x[k] - 10.0 * std::cos(2.0 * M_PI * x[k]);
            return sum;
          }};
}

/// Griewank's in ten dimensions: thousands of minima, the least 0 at the origin.
inline StandardFunction griewank() {
  return {"Griewank", 10, -600.0, 600.0, 0.0, [](const double* x) {
            double sum = 0.0;
            double product = 1.0;
            for (std::size_t k = 0; k < 10; ++k) {
              sum += x[k] * x[k] / 4000.0;
              product *= std::cos(x[k] / std::sqrt(static_cast<double>(k) + 1.0));
            }
            return sum - product + 1.0;
          }};
}

/// Hartman's in three dimensions [DixonSzego1978]: four minima, the least -3.86278.
inline StandardFunction hartman() {
  return {
      "Hartman", 3, 0.0, 1.0, -3.86278, [](const double* x) {
        static constexpr std::array<std::array<double, 3>, 4> kScales{
            {{3.0, 10.0, 30.0}, {0.1, 10.0, 35.0}, {3.0, 10.0, 30.0}, {0.1, 10.0, 35.0}}};
        static constexpr std::array kDepths{1.0, 1.2, 3.0, 3.2};
        static constexpr std::array<std::array<double, 3>, 4> kPlaces{
            {{0.3689, 0.1170, 0.2673}, {0.4699, 0.4387, 0.7470}, {0.1091, 0.8732, 0.5547}, {0.03815, 0.5743, 0.8828}}};
        double sum = 0.0;
        for (std::size_t i = 0; i < 4; ++i) {
          double exponent = 0.0;
          for (std::size_t k = 0; k < 3; ++k) {
            exponent += kScales[i][k] * (x[k] - kPlaces[i][k]) * (x[k] - kPlaces[i][k]);
          }
          sum -= kDepths[i] * std::exp(-exponent);
        }
        return sum;
      }};
}

/// Goldstein and Price's [DixonSzego1978]: four minima, the least 3 at (0, -1).
inline StandardFunction goldstein_price() {
  return {"Goldstein-Price", 2, -2.0, 2.0, 3.0, [](const double* p) {
            const double x = p[0];
            const double y = p[1];
            const double a = x + y + 1.0;
            const double b = 2.0 * x - 3.0 * y;
            return (1.0 + a * a * (19.0 - 14.0 * x + 3.0 * x * x - 14.0 * y + 6.0 * x * y + 3.0 * y * y)) *
                   (30.0 + b * b * (18.0 - 32.0 * x + 12.0 * x * x + 48.0 * y - 36.0 * x * y + 27.0 * y * y));
          }};
}

/// Values it and notes what it was asked for.
class Watched final : public Function {
 public:
  explicit Watched(const StandardFunction& function) : function_(function) {}
  [[nodiscard]] std::size_t dimensions() const override { return function_.dimensions; }
  void evaluate(std::span<const double> points, std::span<double> values) override {
    const std::size_t n = function_.dimensions;
    ++batches;
    evaluations += values.size();
    largest_batch = std::max(largest_batch, values.size());
    last_batch = values.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = function_.value(&points[i * n]);
      least = std::min(least, values[i]);
      for (const double x : points.subspan(i * n, n)) {
        outside += x >= function_.least && x <= function_.most ? 0U : 1U;
      }
    }
  }

  std::uint64_t evaluations = 0;
  std::uint64_t batches = 0;
  std::uint64_t outside = 0;
  std::size_t largest_batch = 0;
  std::size_t last_batch = 0;
  double least = std::numeric_limits<double>::infinity();

 private:
  StandardFunction function_;
};

}  // namespace gdtslam::optimize
