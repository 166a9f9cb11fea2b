// Weighted least squares over many rows with few unknowns each, which lie in blocks of three. Conjugate gradients,
// preconditioned with a factor of a system that leaves out what couples the pieces of a row. Sums in the order of the
// rows: the same bits on every host and for any number of threads. Not thread-safe. Memory: 16 bytes a block of a row.
// Cost: a solution takes some ten to a hundred passes over all rows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/graph/block_cholesky.hpp"
#include "engine/mapping/graph/matrix3.hpp"

namespace gdtslam {

/// The derivatives of a row by one block of unknowns.
struct RowEntry {
  std::uint32_t block = 0;
  std::array<float, 3> derivative{};
};

class SparseRows {
 public:
  /// `pattern`: the pairs of blocks that lie in one piece of a row.
  SparseRows(std::size_t blocks, std::vector<BlockSystem::Pair> pattern, WorkerPool& workers);
  void clear();
  /// Adds weight * (residual + derivatives * step)^2 to what is minimised. A block may be in several pieces.
  void add(std::initializer_list<std::span<const RowEntry>> pieces, double weight, double residual);
  /// The step that minimises the sum; empty if there is none.
  [[nodiscard]] std::vector<Tangent2> solve();
  /// The column of the covariance that belongs to one unknown, after solve().
  [[nodiscard]] std::vector<Tangent2> covariance_column(std::size_t block, std::size_t unknown) const;

 private:
  struct Row {
    std::size_t begin = 0;  // of its entries
    std::size_t count = 0;
    double weight = 0.0;
  };
  [[nodiscard]] std::vector<Tangent2> product(const std::vector<Tangent2>& step) const;
  void add_product(std::span<const Row> rows, const std::vector<Tangent2>& step, std::vector<Tangent2>& sums) const;

  WorkerPool& workers_;
  std::vector<Row> rows_;
  std::vector<RowEntry> entries_;
  BlockSystem near_;
  BlockCholesky factor_;
};

}  // namespace gdtslam
