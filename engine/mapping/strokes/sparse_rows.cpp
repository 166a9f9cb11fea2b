#include "sparse_rows.hpp"

#include <algorithm>
#include <utility>

namespace gdtslam {

namespace {

constexpr std::size_t kPieces = 8;
constexpr NearRules kRules{.share = 1.0e-4, .most_steps = 100};

Tangent2 to_tangent(const RowEntry& entry) {
  return {static_cast<double>(entry.derivative[0]), static_cast<double>(entry.derivative[1]),
          static_cast<double>(entry.derivative[2])};
}

Tangent2 times(double factor, const Tangent2& v) { return {factor * v[0], factor * v[1], factor * v[2]}; }

}  // namespace

SparseRows::SparseRows(std::size_t blocks, std::vector<BlockSystem::Pair> pattern, WorkerPool& workers)
    : workers_(workers), near_(blocks, std::move(pattern)), factor_(near_) {}

void SparseRows::clear() {
  rows_.clear();
  entries_.clear();
  near_.clear();
}

void SparseRows::add(std::initializer_list<std::span<const RowEntry>> pieces, double weight, double residual) {
  rows_.push_back({entries_.size(), 0, weight});
  for (const std::span<const RowEntry> piece : pieces) {
    for (std::size_t a = 0; a < piece.size(); ++a) {
      const Tangent2 derivative = to_tangent(piece[a]);
      const Tangent2 weighted = times(weight, derivative);
      near_.diagonal[piece[a].block] += outer(weighted, derivative);
      gdtslam::add(near_.right[piece[a].block], times(-residual, weighted));
      for (std::size_t b = 0; b < a; ++b) {
        near_.add(piece[a].block, piece[b].block, outer(weighted, to_tangent(piece[b])));
      }
    }
    entries_.insert(entries_.end(), piece.begin(), piece.end());
  }
  rows_.back().count = entries_.size() - rows_.back().begin;
}

// The rows are cut into as many pieces for any number of threads, each with its own sums.
std::vector<Tangent2> SparseRows::product(const std::vector<Tangent2>& step) const {
  const std::size_t piece = (rows_.size() + kPieces - 1) / kPieces;
  std::vector<std::vector<Tangent2>> sums(kPieces);
  workers_.run(kPieces, 1, [&](std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t k = first; k < last; ++k) {
      sums[k].resize(step.size());
      const std::size_t begin = std::min(rows_.size(), k * piece);
      add_product(std::span(rows_).subspan(begin, std::min(piece, rows_.size() - begin)), step, sums[k]);
    }
  });
  for (std::size_t block = 0; block < step.size(); ++block) {
    for (std::size_t k = 1; k < kPieces; ++k) gdtslam::add(sums[0][block], sums[k][block]);
  }
  return std::move(sums[0]);
}

void SparseRows::add_product(std::span<const Row> rows, const std::vector<Tangent2>& step,
                             std::vector<Tangent2>& sums) const {
  for (const Row& row : rows) {
    const std::span<const RowEntry> entries = std::span(entries_).subspan(row.begin, row.count);
    double change = 0.0;
    for (const RowEntry& entry : entries) change += dot(to_tangent(entry), step[entry.block]);
    change *= row.weight;
    for (const RowEntry& entry : entries) gdtslam::add(sums[entry.block], times(change, to_tangent(entry)));
  }
}

std::vector<Tangent2> SparseRows::solve() {
  if (!factor_.factorise(near_)) return {};
  return solve_near([this](const std::vector<Tangent2>& step) { return product(step); }, near_.right, factor_, kRules);
}

std::vector<Tangent2> SparseRows::covariance_column(std::size_t block, std::size_t unknown) const {
  std::vector<Tangent2> right(near_.rows());
  right[block][unknown] = 1.0;
  return solve_near([this](const std::vector<Tangent2>& step) { return product(step); }, right, factor_, kRules);
}

}  // namespace gdtslam
