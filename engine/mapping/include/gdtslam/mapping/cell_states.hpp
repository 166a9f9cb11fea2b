// What is known of the cells of a map, one after the other: two bits each, and none for stretches of 512 of which
// nothing is known. One object belongs to one thread, constant ones to all.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace gdtslam {

enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

class CellStates {
 public:
  CellStates() = default;
  /// So many unknown cells.
  explicit CellStates(std::size_t size) : size_(size), blocks_((size + kBlock - 1) / kBlock) {}
  explicit CellStates(std::span<const CellState> states);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] CellState operator[](std::size_t cell) const {
    const std::uint32_t block = blocks_[cell / kBlock];
    return block == 0 ? CellState::kUnknown : state_in(pool_[block - 1], cell % kBlock);
  }
  void set(std::size_t cell, CellState state) {
    std::uint32_t& block = blocks_[cell / kBlock];
    if (block == 0) {
      if (state == CellState::kUnknown) return;
      pool_.push_back({});
      block = static_cast<std::uint32_t>(pool_.size());
    }
    std::uint64_t& word = pool_[block - 1][cell % kBlock / kInWord];
    const std::size_t shift = 2 * (cell % kInWord);
    word = (word & ~(std::uint64_t{3} << shift)) | static_cast<std::uint64_t>(state) << shift;
  }
  /// The states from a cell on.
  void read(std::size_t first, std::span<CellState> states) const;
  [[nodiscard]] std::vector<CellState> all() const;
  friend bool operator==(const CellStates& a, const CellStates& b) { return a.all() == b.all(); }

 private:
  static constexpr std::size_t kBlock = 512;
  static constexpr std::size_t kInWord = 32;
  using Block = std::array<std::uint64_t, kBlock / kInWord>;
  static CellState state_in(const Block& block, std::size_t cell) {
    return static_cast<CellState>(block[cell / kInWord] >> (2 * (cell % kInWord)) & 3U);
  }

  std::size_t size_ = 0;
  std::vector<std::uint32_t> blocks_;  // 0, or one more than its place in the pool
  std::deque<Block> pool_;
};

}  // namespace gdtslam
