#include "conjugate_gradients.hpp"

#include <cmath>
#include <cstddef>
#include <span>

namespace gdtslam {
namespace {

constexpr int kMostDirections = 400;
constexpr double kSolvedShare = 1.0e-8;  // share of the squared error to begin with, in the factor's norm

double dot_product(const std::vector<Tangent2>& a, const std::vector<Tangent2>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
  return sum;
}

// a += factor * b
void add_times(std::vector<Tangent2>& a, double factor, const std::vector<Tangent2>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) a[i][k] += factor * b[i][k];
  }
}

std::vector<Tangent2> product(const BlockSystem& system, const std::vector<Tangent2>& v) {
  std::vector<Tangent2> result(v.size());
  for (std::size_t row = 0; row < v.size(); ++row) add(result[row], system.diagonal[row] * v[row]);
  for (std::size_t row = 0; row < v.size(); ++row) {
    const std::span<const std::size_t> columns = system.row_columns(row);
    for (std::size_t nth = 0; nth < columns.size(); ++nth) {
      const Matrix3& block = system.block(row, nth);
      add(result[row], block * v[columns[nth]]);
      add(result[columns[nth]], transposed(block) * v[row]);
    }
  }
  return result;
}

}  // namespace

std::vector<Tangent2> solve_near(const BlockSystem& system, const BlockCholesky& factor) {
  std::vector<Tangent2> solution(system.rows());
  std::vector<Tangent2> residual = system.right;
  std::vector<Tangent2> downhill = residual;
  factor.solve(downhill);
  std::vector<Tangent2> direction = downhill;
  double error = dot_product(residual, downhill);
  const double small = kSolvedShare * error;
  for (int step = 0; step < kMostDirections && error > small; ++step) {
    const std::vector<Tangent2> changed = product(system, direction);
    const double share = error / dot_product(direction, changed);
    add_times(solution, share, direction);
    add_times(residual, -share, changed);
    downhill = residual;
    factor.solve(downhill);
    const double left = dot_product(residual, downhill);
    for (std::size_t i = 0; i < direction.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) direction[i][k] = downhill[i][k] + left / error * direction[i][k];
    }
    error = left;
  }
  if (!std::isfinite(error)) return {};
  return solution;
}

}  // namespace gdtslam
