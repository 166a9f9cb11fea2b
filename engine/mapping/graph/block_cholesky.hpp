// Sparse symmetric systems of 3 x 3 blocks, one row a pose, and their Cholesky factorisation [Davis2006, chapter 4].
// The elimination order has small fill and comes from the pattern alone; sums are scalar, in that fixed order, so that
// every host gives the same bits. Not thread-safe. Cost: the factor's blocks; some milliseconds for a thousand poses of
// a path with loops (docs/benchmarks.md).
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "matrix3.hpp"

namespace gdtslam {

/// A symmetric matrix by its lower triangle, and a right side. The pattern is fixed at construction: the diagonal and
/// the pairs given.
class BlockSystem {
 public:
  using Pair = std::pair<std::size_t, std::size_t>;
  BlockSystem(std::size_t rows, std::vector<Pair> pairs);

  [[nodiscard]] std::size_t rows() const { return diagonal.size(); }
  void clear();
  /// Adds to the block at (row, column), and the transpose to (column, row); the pair must be in the pattern.
  void add(std::size_t row, std::size_t column, const Matrix3& block);

  std::vector<Matrix3> diagonal;
  std::vector<Tangent2> right;

  /// Columns left of the diagonal, ascending, and their blocks.
  [[nodiscard]] std::span<const std::size_t> row_columns(std::size_t row) const {
    return std::span(columns_).subspan(begin_[row], begin_[row + 1] - begin_[row]);
  }
  [[nodiscard]] const Matrix3& block(std::size_t row, std::size_t nth) const { return blocks_[begin_[row] + nth]; }

 private:
  std::vector<std::size_t> begin_;  // begin of each row's entries
  std::vector<std::size_t> columns_;
  std::vector<Matrix3> blocks_;
};

class BlockCholesky {
 public:
  /// Chooses the elimination order for systems of this pattern.
  explicit BlockCholesky(const BlockSystem& pattern);

  /// Returns false if the system is not positive definite; it cannot be solved then.
  [[nodiscard]] bool factorise(const BlockSystem& system);
  /// The solution, in place.
  void solve(std::vector<Tangent2>& right) const;
  /// Number of blocks of the factor: each takes 72 bytes, and 8 of indices.
  [[nodiscard]] std::size_t factor_blocks() const { return blocks_.size(); }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  /// A block of the system in elimination order: left of the diagonal.
  struct Source {
    std::size_t column = 0;
    std::size_t row_of_system = 0;
    std::size_t nth = 0;
    bool is_transposed = false;
  };
  void choose_order(const BlockSystem& pattern);
  void sort_sources(const BlockSystem& pattern);
  void find_parents();
  void lay_out();
  void reach(std::size_t row);
  bool eliminate(std::size_t row, const BlockSystem& system);

  std::vector<std::size_t> old_of_;  // old index of each row in the elimination order
  std::vector<std::size_t> new_of_;
  std::vector<std::vector<Source>> sources_;  // sources of each row, in elimination order from here on
  std::vector<std::size_t> parent_;           // parent of each row in the elimination tree
  // The factor below its diagonal: column by column, the blocks of a column in the order of their rows.
  std::vector<std::size_t> begin_;  // begin of each column, and the end of the last
  std::vector<std::size_t> end_;    // end of the eliminated part of each column
  std::vector<std::size_t> rows_;
  std::vector<Matrix3> blocks_;
  std::vector<Matrix3> diagonal_;     // lower triangular
  std::vector<Matrix3> row_;          // the current row; zero outside `reached_`
  std::vector<std::size_t> reached_;  // columns in which the current row has blocks
  std::vector<std::size_t> marked_;   // the last row that reached each column
};

// Solves systems whose own factor would be large: conjugate gradients, preconditioned with the factor of a similar
// system [GolubVanLoan2013, section 11.5]; for graphs, a system of part of the edges [Dellaert2010]. Sums in a fixed
// order, the same bits on every host. Cost: a product and a solution with the factor a step.

/// When solve_near() ends.
struct NearRules {
  double share = 1.0e-8;  ///< of the initial squared error, in the factor's norm
  int most_steps = 400;
};

/// Solves for system.right to a ten-thousandth, or as far as some hundred steps reach, each nearer than the last. An
/// empty result means that the systems have values that are not finite.
std::vector<Tangent2> solve_near(const BlockSystem& system, const BlockCholesky& factor);

/// Multiplies a system with a vector.
using BlockProduct = std::function<std::vector<Tangent2>(const std::vector<Tangent2>&)>;
/// Solves a system that is known by its products alone, until `rules` say that it is enough.
std::vector<Tangent2> solve_near(const BlockProduct& times_system, const std::vector<Tangent2>& right,
                                 const BlockCholesky& factor, const NearRules& rules);

}  // namespace gdtslam
