#include "block_cholesky.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

namespace gdtslam {
namespace {

bool is_positive(const Matrix3& factor) {
  const auto is_pivot = [&](int i) { return std::isfinite(factor(i, i)) && factor(i, i) > 0.0; };
  return is_pivot(0) && is_pivot(1) && is_pivot(2);
}

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

BlockSystem::BlockSystem(std::size_t rows, std::vector<Pair> pairs) : diagonal(rows), right(rows), begin_(rows + 1, 0) {
  for (auto& [row, column] : pairs) {
    assert(row != column && row < rows && column < rows);
    if (row < column) std::swap(row, column);
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  columns_.reserve(pairs.size());
  for (const auto& [row, column] : pairs) {
    ++begin_[row + 1];
    columns_.push_back(column);
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  blocks_.resize(pairs.size());
}

void BlockSystem::clear() {
  std::fill(diagonal.begin(), diagonal.end(), Matrix3{});
  std::fill(right.begin(), right.end(), Tangent2{});
  std::fill(blocks_.begin(), blocks_.end(), Matrix3{});
}

void BlockSystem::add(std::size_t row, std::size_t column, const Matrix3& block) {
  const bool is_lower = row > column;
  const std::size_t low = is_lower ? row : column;
  const std::size_t left = is_lower ? column : row;
  const auto begin = columns_.begin() + static_cast<std::ptrdiff_t>(begin_[low]);
  const auto end = columns_.begin() + static_cast<std::ptrdiff_t>(begin_[low + 1]);
  const auto found = std::lower_bound(begin, end, left);
  assert(found != end && *found == left);
  blocks_[static_cast<std::size_t>(found - columns_.begin())] += is_lower ? block : transposed(block);
}

BlockCholesky::BlockCholesky(const BlockSystem& pattern)
    : sources_(pattern.rows()), parent_(pattern.rows(), kNone), diagonal_(pattern.rows()), row_(pattern.rows()) {
  choose_order(pattern);
  sort_sources(pattern);
  find_parents();
  lay_out();
}

// Approximate minimum degree [Amestoy1996], integers alone.
void BlockCholesky::choose_order(const BlockSystem& pattern) {
  const auto rows = static_cast<Eigen::Index>(pattern.rows());
  std::vector<Eigen::Triplet<double, int>> entries;
  for (std::size_t row = 0; row < pattern.rows(); ++row) {
    entries.emplace_back(static_cast<int>(row), static_cast<int>(row), 1.0);
    for (const std::size_t column : pattern.row_columns(row)) {
      entries.emplace_back(static_cast<int>(row), static_cast<int>(column), 1.0);
      entries.emplace_back(static_cast<int>(column), static_cast<int>(row), 1.0);
    }
  }
  Eigen::SparseMatrix<double> matrix(rows, rows);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(matrix, order);
  old_of_.resize(pattern.rows());
  new_of_.resize(pattern.rows());
  for (std::size_t i = 0; i < pattern.rows(); ++i) {
    old_of_[i] = static_cast<std::size_t>(order.indices()[static_cast<Eigen::Index>(i)]);
    new_of_[old_of_[i]] = i;
  }
}

void BlockCholesky::sort_sources(const BlockSystem& pattern) {
  for (std::size_t row = 0; row < pattern.rows(); ++row) {
    const std::span<const std::size_t> columns = pattern.row_columns(row);
    for (std::size_t nth = 0; nth < columns.size(); ++nth) {
      const std::size_t a = new_of_[row];
      const std::size_t b = new_of_[columns[nth]];
      sources_[std::max(a, b)].push_back(
          {.column = std::min(a, b), .row_of_system = row, .nth = nth, .is_transposed = a < b});
    }
  }
}

// [Davis2006, section 4.1]: the parent of a column is the first row below its diagonal in which the factor has a block.
void BlockCholesky::find_parents() {
  std::vector<std::size_t> ancestor(parent_.size(), kNone);
  for (std::size_t row = 0; row < sources_.size(); ++row) {
    for (const Source& source : sources_[row]) {
      for (std::size_t at = source.column; at != kNone && at < row;) {
        const std::size_t next = ancestor[at];
        ancestor[at] = row;
        if (next == kNone) parent_[at] = row;
        at = next;
      }
    }
  }
}

// The blocks of the factor depend on the pattern alone.
void BlockCholesky::lay_out() {
  begin_.assign(sources_.size() + 1, 0);
  marked_.assign(sources_.size(), kNone);
  for (std::size_t row = 0; row < sources_.size(); ++row) {
    reach(row);
    for (const std::size_t column : reached_) ++begin_[column + 1];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  end_.resize(sources_.size());
  rows_.resize(begin_.back());
  blocks_.resize(begin_.back());
}

// The columns of a row of the factor: those of the system and their ancestors.
void BlockCholesky::reach(std::size_t row) {
  reached_.clear();
  for (const Source& source : sources_[row]) {
    for (std::size_t at = source.column; at < row && marked_[at] != row; at = parent_[at]) {
      marked_[at] = row;
      reached_.push_back(at);
    }
  }
}

bool BlockCholesky::eliminate(std::size_t row, const BlockSystem& system) {
  reach(row);
  std::sort(reached_.begin(), reached_.end());  // a child comes before its parent
  for (const Source& source : sources_[row]) {
    const Matrix3& block = system.block(source.row_of_system, source.nth);
    row_[source.column] = source.is_transposed ? transposed(block) : block;
  }
  Matrix3 pivot = system.diagonal[old_of_[row]];
  for (const std::size_t column : reached_) {
    const Matrix3 block = over_transposed(row_[column], diagonal_[column]);
    row_[column] = {};
    const std::size_t end = end_[column];
    for (std::size_t k = begin_[column]; k < end; ++k) row_[rows_[k]] -= times_transposed(block, blocks_[k]);
    pivot -= times_transposed(block, block);
    rows_[end] = row;
    blocks_[end] = block;
    ++end_[column];
  }
  diagonal_[row] = cholesky(pivot);
  return is_positive(diagonal_[row]);
}

bool BlockCholesky::factorise(const BlockSystem& system) {
  assert(system.rows() == diagonal_.size());
  marked_.assign(diagonal_.size(), kNone);
  std::copy(begin_.begin(), begin_.end() - 1, end_.begin());
  for (std::size_t row = 0; row < diagonal_.size(); ++row) {
    if (!eliminate(row, system)) return false;
  }
  return true;
}

void BlockCholesky::solve(std::vector<Tangent2>& right) const {
  std::vector<Tangent2> x(right.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = right[old_of_[i]];
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = solve_lower(diagonal_[i], x[i]);
    for (std::size_t k = begin_[i]; k < begin_[i + 1]; ++k) subtract(x[rows_[k]], blocks_[k] * x[i]);
  }
  for (std::size_t i = x.size(); i-- > 0;) {
    for (std::size_t k = begin_[i]; k < begin_[i + 1]; ++k) subtract(x[i], transposed(blocks_[k]) * x[rows_[k]]);
    x[i] = solve_lower_transposed(diagonal_[i], x[i]);
  }
  for (std::size_t i = 0; i < x.size(); ++i) right[old_of_[i]] = x[i];
}

std::vector<Tangent2> solve_near(const BlockSystem& system, const BlockCholesky& factor) {
  return solve_near([&system](const std::vector<Tangent2>& v) { return product(system, v); }, system.right, factor, {});
}

std::vector<Tangent2> solve_near(const BlockProduct& times_system, const std::vector<Tangent2>& right,
                                 const BlockCholesky& factor, const NearRules& rules) {
  std::vector<Tangent2> solution(right.size());
  std::vector<Tangent2> residual = right;
  std::vector<Tangent2> downhill = residual;
  factor.solve(downhill);
  std::vector<Tangent2> direction = downhill;
  double error = dot_product(residual, downhill);
  const double small = rules.share * error;
  for (int step = 0; step < rules.most_steps && error > small; ++step) {
    const std::vector<Tangent2> changed = times_system(direction);
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
