#include "tile_counts.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace gdtslam {
namespace {

constexpr std::size_t kCounterBits = 16;
constexpr std::size_t kStripRows = 8;  // counted together

/// Some rows of cells.
using Strip = std::array<std::uint64_t, kStripRows>;

// Adds one bit in a plane; the carries are left in `carry`. Returns true if there are any.
bool add_to_plane(std::uint64_t* plane, Strip& carry) {
  std::uint64_t any = 0;
  for (std::size_t k = 0; k < kStripRows; ++k) {
    const std::uint64_t was = plane[k];
    plane[k] = was ^ carry[k];
    carry[k] &= was;
    any |= carry[k];
  }
  return any != 0;
}

// Adds both to a plane; the carries are left in `carry`, and `waiting` becomes empty.
void add_to_plane(TileBits& plane, TileBits& waiting, TileBits& carry) {
  for (std::size_t row = 0; row < plane.size(); ++row) {
    const std::uint64_t differ = waiting[row] ^ carry[row];
    carry[row] = (waiting[row] & carry[row]) | (plane[row] & differ);
    plane[row] ^= differ;
    waiting[row] = 0;
  }
}

std::uint64_t any_of(const std::vector<TileBits>& planes, std::size_t row) {
  std::uint64_t any = 0;
  for (const TileBits& plane : planes) any |= plane[row];
  return any;
}

std::uint32_t read_counter(const std::vector<TileBits>& planes, std::size_t row, unsigned column) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    value |= static_cast<std::uint32_t>(planes[k][row] >> column & 1U) << k;
  }
  return value;
}

}  // namespace

void TileCounts::increment(Planes& planes, std::size_t first_plane, const TileBits& cells) {
  for (std::size_t row = 0; row < cells.size(); row += kStripRows) {
    Strip carry{};
    std::copy_n(&cells[row], kStripRows, carry.begin());
    bool has_carry = std::any_of(carry.begin(), carry.end(), [](std::uint64_t word) { return word != 0; });
    for (std::size_t k = first_plane; has_carry; ++k) {
      while (k >= planes.size()) {
        planes.reserve(planes.size() + 1);  // a plane is large, and often none follows for long
        planes.emplace_back();
      }
      has_carry = add_to_plane(&planes[k][row], carry);
    }
  }
}

void TileCounts::halve(Planes& planes, std::size_t row, std::uint64_t cells) {
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const std::uint64_t next = k + 1 < planes.size() ? planes[k + 1][row] : 0;
    planes[k][row] = (planes[k][row] & ~cells) | (next & cells);
  }
}

void TileCounts::halve_full(const Planes& planes) {
  if (planes.size() < kCounterBits) return;
  settle();
  for (std::size_t row = 0; row < kTileSide; ++row) {
    std::uint64_t full = ~std::uint64_t{0};
    for (const TileBits& plane : planes) full &= plane[row];
    if (full == 0) continue;
    halve(ends_, row, full);
    halve(passes_, row, full);
  }
}

// Adds the waiting counts to the planes.
void TileCounts::settle() {
  if (has_ones_) increment(passes_, 0, ones_);
  if (has_twos_) increment(passes_, 1, twos_);
  if (has_ones_) ones_.fill(0);
  if (has_twos_) twos_.fill(0);
  has_ones_ = has_twos_ = false;
}

// Before a count can become full, all waiting ones are added.
void TileCounts::add_passes(const TileBits& cells) {
  if (passes_.size() + 1 >= kCounterBits) {
    settle();
    increment(passes_, 0, cells);
    return halve_full(passes_);
  }
  if (!std::exchange(has_ones_, !has_ones_)) {
    ones_ = cells;
    return;
  }
  if (passes_.size() < 2) passes_.resize(2);
  TileBits carry = cells;
  add_to_plane(passes_[0], ones_, carry);
  if (!std::exchange(has_twos_, !has_twos_)) {
    twos_ = carry;
    return;
  }
  add_to_plane(passes_[1], twos_, carry);
  increment(passes_, 2, carry);
}

void TileCounts::add(const TileBits& ends, const TileBits& passes) {
  increment(ends_, 0, ends);
  halve_full(ends_);
  add_passes(passes);
}

std::uint64_t TileCounts::ended(std::size_t row) const { return any_of(ends_, row); }
std::uint64_t TileCounts::passed(std::size_t row) const { return any_of(passes_, row) | ones_[row] | twos_[row]; }

TileCounts::Cell TileCounts::at(std::size_t row, unsigned column) const {
  const auto waiting = static_cast<std::uint32_t>((ones_[row] >> column & 1U) + 2 * (twos_[row] >> column & 1U));
  return {read_counter(ends_, row, column), read_counter(passes_, row, column) + waiting};
}

}  // namespace gdtslam
