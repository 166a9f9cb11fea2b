// Least squares over sparse rows against the same rows in a dense matrix of Eigen.
#include "engine/mapping/strokes/sparse_rows.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

using Eigen::Index;
using Pieces = std::vector<std::vector<RowEntry>>;

constexpr std::size_t kRowBlocks = 14;

/// The rows of one problem and, in full, the normal equations of them and of their pieces each by itself.
struct RowProblem {
  explicit RowProblem(WorkerPool& workers) : rows(kRowBlocks, all_pairs(), workers) {}

  static std::vector<BlockSystem::Pair> all_pairs() {
    std::vector<BlockSystem::Pair> pairs;
    for (std::size_t a = 0; a < kRowBlocks; ++a) {
      for (std::size_t b = 0; b < a; ++b) pairs.emplace_back(a, b);
    }
    return pairs;
  }
  void add(const Pieces& pieces, double weight, double residual) {
    const auto size = static_cast<Index>(3 * kRowBlocks);
    Eigen::VectorXd whole = Eigen::VectorXd::Zero(size);
    for (const std::vector<RowEntry>& piece : pieces) {
      Eigen::VectorXd part = Eigen::VectorXd::Zero(size);
      for (const RowEntry& entry : piece) {
        for (std::size_t i = 0; i < 3; ++i) {
          part[static_cast<Index>(3 * entry.block + i)] = static_cast<double>(entry.derivative[i]);
        }
      }
      by_pieces += weight * part * part.transpose();
      whole += part;
    }
    information += weight * whole * whole.transpose();
    right -= weight * residual * whole;
    if (pieces.size() == 1) rows.add({pieces[0]}, weight, residual);
    if (pieces.size() == 2) rows.add({pieces[0], pieces[1]}, weight, residual);
    if (pieces.size() == 3) rows.add({pieces[0], pieces[1], pieces[2]}, weight, residual);
  }

  SparseRows rows;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(3 * kRowBlocks, 3 * kRowBlocks);
  Eigen::MatrixXd by_pieces = information;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(3 * kRowBlocks);
};

/// Up to four entries of different blocks.
std::vector<RowEntry> draw_piece(Random& random) {
  std::vector<RowEntry> piece;
  auto block = static_cast<std::uint32_t>(random.below(4));
  for (; block < kRowBlocks && piece.size() < 4; block += 1 + static_cast<std::uint32_t>(random.below(5))) {
    piece.push_back({block, {}});
    for (float& value : piece.back().derivative) value = static_cast<float>(random.uniform(-1.0, 1.0));
  }
  return piece;
}

void fill_rows(RowProblem& problem, std::size_t most_pieces) {
  Random random(5);
  for (int row = 0; row < 400; ++row) {
    Pieces pieces(1 + random.below(most_pieces));
    for (std::vector<RowEntry>& piece : pieces) piece = draw_piece(random);  // a block may be in several
    const double weight = random.uniform(0.5, 5.0);
    problem.add(pieces, weight, random.normal());
  }
}

Eigen::VectorXd flat(const std::vector<Tangent2>& blocks) {
  Eigen::VectorXd values(static_cast<Index>(3 * blocks.size()));
  for (Index k = 0; k < values.size(); ++k)
    values[k] = blocks[static_cast<std::size_t>(k / 3)][static_cast<std::size_t>(k % 3)];
  return values;
}

// The factor is of the whole system then, so one step of the conjugate gradients is exact.
TEST(SparseRows, RowsOfOnePieceAreSolvedExactly) {
  WorkerPool workers(1);
  RowProblem problem(workers);
  fill_rows(problem, 1);
  const Eigen::VectorXd expected = problem.information.ldlt().solve(problem.right);
  ASSERT_GT(expected.norm(), 0.1);
  EXPECT_LT((flat(problem.rows.solve()) - expected).norm(), 1.0e-10 * expected.norm());
}

// The conjugate gradients end when the squared error is a ten-thousandth of the first in the norm of the pieces'
// factor.
TEST(SparseRows, RowsOfSeveralPiecesAreSolvedAsFarAsPromised) {
  WorkerPool workers(1);
  RowProblem problem(workers);
  fill_rows(problem, 3);
  const auto factor = problem.by_pieces.ldlt();
  const auto full = problem.information.ldlt();
  const auto expect_near = [&](const Eigen::VectorXd& found, const Eigen::VectorXd& right) {
    const Eigen::VectorXd left = right - problem.information * found;
    EXPECT_LE(left.dot(factor.solve(left)), 1.0001e-4 * right.dot(factor.solve(right)));
    const Eigen::VectorXd expected = full.solve(right);
    EXPECT_LT((found - expected).norm(), 0.05 * expected.norm());
  };
  ASSERT_GT((problem.information - problem.by_pieces).norm(), 0.1 * problem.information.norm());
  expect_near(flat(problem.rows.solve()), problem.right);
  for (const auto& [block, unknown] : {std::pair<std::size_t, std::size_t>{0, 2}, {7, 0}, {13, 1}}) {
    const Eigen::VectorXd one = Eigen::VectorXd::Unit(3 * kRowBlocks, static_cast<Index>(3 * block + unknown));
    expect_near(flat(problem.rows.covariance_column(block, unknown)), one);
  }
}

TEST(SparseRows, TheNumberOfThreadsDoesNotChangeABit) {
  WorkerPool one(1);
  WorkerPool four(4);
  RowProblem a(one);
  RowProblem b(four);
  fill_rows(a, 3);
  fill_rows(b, 3);
  EXPECT_EQ(a.rows.solve(), b.rows.solve());
  EXPECT_EQ(a.rows.covariance_column(4, 1), b.rows.covariance_column(4, 1));
}

TEST(SparseRows, WithoutAMinimumThereIsNoStep) {
  WorkerPool workers(1);
  SparseRows rows(2, {{1, 0}}, workers);
  const std::vector<RowEntry> piece{{0, {1.0F, 0.0F, 0.0F}}};  // says nothing about five of six unknowns
  rows.add({piece}, 1.0, 1.0);
  EXPECT_TRUE(rows.solve().empty());
}

}  // namespace
}  // namespace gdtslam
