// The sparse factorisation against dense ones of Eigen.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "engine/mapping/graph/block_cholesky.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

using Dense = Eigen::MatrixXd;

Eigen::Matrix3d dense_of(const Matrix3& block) {
  Eigen::Matrix3d dense;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) dense(i, j) = block(i, j);
  }
  return dense;
}

Matrix3 random_block(Random& random) {
  Matrix3 block;
  for (double& value : block.m) value = random.uniform(-1.0, 1.0);
  return block;
}

/// A path of poses with loops between some that are far apart, and the same matrix in full.
struct Problem {
  Problem(std::size_t rows, std::size_t loops, std::uint64_t seed);

  Random random;
  BlockSystem system;
  Dense dense;
  Eigen::VectorXd right;
};

std::vector<BlockSystem::Pair> pairs_of(std::size_t rows, std::size_t loops, Random& random) {
  std::vector<BlockSystem::Pair> pairs;
  for (std::size_t i = 1; i < rows; ++i) pairs.emplace_back(i - 1, i);
  while (rows > 2 && loops-- > 0) {
    const std::size_t a = random.below(rows);
    const std::size_t b = random.below(rows);
    if (a != b) pairs.emplace_back(a, b);
  }
  return pairs;
}

Dense square_of_zeros(std::size_t size) {
  return Dense::Zero(static_cast<Eigen::Index>(size), static_cast<Eigen::Index>(size));
}

Problem::Problem(std::size_t rows, std::size_t loops, std::uint64_t seed)
    : random(seed), system(rows, pairs_of(rows, loops, random)), dense(square_of_zeros(3 * rows)) {
  for (std::size_t row = 0; row < rows; ++row) {
    const auto at = static_cast<Eigen::Index>(3 * row);
    for (const std::size_t column : system.row_columns(row)) {
      const Matrix3 block = random_block(random);
      system.add(row, column, block);
      const auto left = static_cast<Eigen::Index>(3 * column);
      dense.block<3, 3>(at, left) += dense_of(block);
      dense.block<3, 3>(left, at) += dense_of(block).transpose();
    }
    const Matrix3 half = random_block(random);
    // Diagonally dominant, hence positive definite.
    const Matrix3 diagonal = times_transposed(half, half) + Matrix3::diagonal(60.0, 60.0, 60.0);
    system.diagonal[row] += diagonal;
    dense.block<3, 3>(at, at) += dense_of(diagonal);
    for (double& value : system.right[row]) value = random.uniform(-5.0, 5.0);
  }
  right.resize(static_cast<Eigen::Index>(3 * rows));
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t k = 0; k < 3; ++k) right[static_cast<Eigen::Index>(3 * i + k)] = system.right[i][k];
  }
}

TEST(BlockCholesky, SolvesWhatADenseFactorisationSolves) {
  for (const std::size_t rows : {1U, 2U, 3U, 17U, 120U}) {
    for (const std::size_t loops : {0U, 1U, 9U, 60U}) {
      Problem problem(rows, loops, 7 * rows + loops);
      BlockCholesky factor(problem.system);
      ASSERT_TRUE(factor.factorise(problem.system));
      std::vector<Tangent2> found = problem.system.right;
      factor.solve(found);
      const Eigen::VectorXd expected = problem.dense.ldlt().solve(problem.right);
      for (std::size_t i = 0; i < rows; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_NEAR(found[i][k], expected[static_cast<Eigen::Index>(3 * i + k)], 1e-12) << rows << ' ' << loops;
        }
      }
    }
  }
}

TEST(BlockCholesky, IsUsedAgainForOtherValuesOfThePattern) {
  Problem problem(40, 12, 3);
  BlockCholesky factor(problem.system);
  ASSERT_TRUE(factor.factorise(problem.system));
  std::vector<Tangent2> once = problem.system.right;
  factor.solve(once);
  for (Matrix3& block : problem.system.diagonal) block += Matrix3::diagonal(100.0, 1.0, 7.0);
  ASSERT_TRUE(factor.factorise(problem.system));
  std::vector<Tangent2> again = problem.system.right;
  factor.solve(again);
  EXPECT_NE(once, again);
  BlockCholesky fresh(problem.system);
  ASSERT_TRUE(fresh.factorise(problem.system));
  std::vector<Tangent2> expected = problem.system.right;
  fresh.solve(expected);
  EXPECT_EQ(again, expected) << "to the bit";
}

// Whose exact solution is Eigen's, of the changed matrix in full.
TEST(SolveNear, SolvesASystemThatChangedByLittleWithTheOldFactor) {
  Problem problem(60, 25, 8);
  BlockCholesky factor(problem.system);
  ASSERT_TRUE(factor.factorise(problem.system));
  for (std::size_t row = 0; row < problem.system.rows(); ++row) {
    const Matrix3 more = Matrix3::diagonal(6.0, 3.0, 0.5 * static_cast<double>(row % 7));
    problem.system.diagonal[row] += more;
    const auto at = static_cast<Eigen::Index>(3 * row);
    problem.dense.block<3, 3>(at, at) += dense_of(more);
  }
  const std::vector<Tangent2> solution = solve_near(problem.system, factor);
  ASSERT_EQ(solution.size(), 60U);
  const Eigen::VectorXd expected = problem.dense.llt().solve(problem.right);
  for (std::size_t i = 0; i < solution.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(solution[i][k], expected[static_cast<Eigen::Index>(3 * i + k)], 1e-3 * expected.norm());
    }
  }
}

TEST(SolveNear, TakesMoreStepsWhereTheSystemsHaveLittleInCommon) {
  Problem problem(60, 25, 9);
  BlockCholesky factor(problem.system);
  ASSERT_TRUE(factor.factorise(problem.system));
  Random random(4);
  for (std::size_t row = 0; row < problem.system.rows(); ++row) {
    const Matrix3 more =
        Matrix3::diagonal(random.uniform(0.0, 1e6), random.uniform(0.0, 1e3), random.uniform(0.0, 1e5));
    problem.system.diagonal[row] += more;
    const auto at = static_cast<Eigen::Index>(3 * row);
    problem.dense.block<3, 3>(at, at) += dense_of(more);
  }
  const std::vector<Tangent2> solution = solve_near(problem.system, factor);
  ASSERT_EQ(solution.size(), 60U);
  Eigen::VectorXd found(180);
  for (std::size_t i = 0; i < solution.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) found[static_cast<Eigen::Index>(3 * i + k)] = solution[i][k];
  }
  const Eigen::VectorXd error = found - problem.dense.llt().solve(problem.right);
  const double size = problem.right.dot(problem.dense.llt().solve(problem.right));
  EXPECT_LT(error.dot(problem.dense * error), 1e-6 * size) << "in the system's norm";
  problem.system.diagonal[7](0, 0) = std::nan("");
  EXPECT_TRUE(solve_near(problem.system, factor).empty());
}

TEST(SolveNear, AsksForNoStepWhereNothingPulls) {
  Problem problem(12, 3, 10);
  BlockCholesky factor(problem.system);
  ASSERT_TRUE(factor.factorise(problem.system));
  for (Tangent2& value : problem.system.right) value = {};
  EXPECT_EQ(solve_near(problem.system, factor), std::vector<Tangent2>(12));
}

TEST(BlockCholesky, SaysWhereNothingCanBeSolved) {
  Problem problem(9, 2, 5);
  problem.system.diagonal[4] = {};
  BlockCholesky factor(problem.system);
  EXPECT_FALSE(factor.factorise(problem.system));
  problem.system.diagonal[4] = Matrix3::diagonal(-1.0, 1.0, 1.0);
  EXPECT_FALSE(factor.factorise(problem.system));
  problem.system.diagonal[4] = Matrix3::diagonal(1e3, 1e3, 1e3);
  EXPECT_TRUE(factor.factorise(problem.system));
}

// A path without loops needs no block but its own: any order that fills it in is a bad one.
TEST(BlockCholesky, AChainFillsNothingIn) {
  Problem problem(500, 0, 11);
  BlockCholesky factor(problem.system);
  ASSERT_TRUE(factor.factorise(problem.system));
  EXPECT_EQ(factor.factor_blocks(), 499U);
}

// Eliminated first, a row that all others are tied to would tie them to each other.
TEST(BlockCholesky, AStarFillsNothingIn) {
  constexpr std::size_t kSpokes = 100;
  std::vector<BlockSystem::Pair> pairs;
  for (std::size_t k = 1; k <= kSpokes; ++k) pairs.emplace_back(0, k);
  BlockSystem system(kSpokes + 1, pairs);
  for (Matrix3& block : system.diagonal) block = static_cast<double>(kSpokes + 1) * Matrix3::identity();
  for (std::size_t k = 1; k <= kSpokes; ++k) system.add(k, 0, Matrix3::identity());
  BlockCholesky factor(system);
  ASSERT_TRUE(factor.factorise(system));
  EXPECT_EQ(factor.factor_blocks(), kSpokes);
}

TEST(Matrix3, InverseAndFactorAreThoseOfEigen) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Matrix3 half = random_block(random);
    const Matrix3 matrix = times_transposed(half, half) + Matrix3::diagonal(0.1, 0.2, 0.3);
    EXPECT_LT((dense_of(inverse(matrix)) - dense_of(matrix).inverse()).norm(), 1e-10);
    const Eigen::Matrix3d factor = dense_of(matrix).llt().matrixL();
    EXPECT_LT((dense_of(cholesky(matrix)) - factor).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace gdtslam
