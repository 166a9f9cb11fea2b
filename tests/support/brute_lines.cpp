#include "brute_lines.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "single.hpp"

namespace gdtslam::test {
namespace {

struct Arrow {
  Single x, y;
};

Arrow operator-(Arrow a, Arrow b) { return {a.x - b.x, a.y - b.y}; }
Single dot(Arrow a, Arrow b) { return a.x * b.x + a.y * b.y; }

Arrow placed(const PointToLine::Pose& at, Arrow p) {
  return {(Single{at.cos} * p.x - Single{at.sin} * p.y) + Single{at.x},
          (Single{at.sin} * p.x + Single{at.cos} * p.y) + Single{at.y}};
}

/// Out of the frame of the fixed scan into that of the moving one.
Arrow turned_back(const PointToLine::Pose& at, Arrow v) {
  return {Single{at.cos} * v.x + Single{at.sin} * v.y, Single{at.cos} * v.y - Single{at.sin} * v.x};
}

Single direction_of(Arrow p) {
  const Single length = Single{std::fabs(p.x.value)} + Single{std::fabs(p.y.value)};
  const Single share = p.y * reciprocal(length.value > 1.0e-18F ? length : Single{1.0F});
  return p.x.value >= 0.0F ? share : Single{p.y.value < 0.0F ? -2.0F : 2.0F} - share;
}

/// A pair of scans in the buffers.
struct LinePair {
  const PointToLine::Params& params;
  const std::vector<float>& values;
  const std::vector<std::uint16_t>& bins;
  const PointToLine::Pair& pair;

  [[nodiscard]] PointToLine::Sums sums() const {
    std::array<std::array<Single, PointToLine::kLanes>, PointToLine::kSums> lanes{};
    for (std::size_t j = 0; j < pair.taken; ++j) {
      const auto terms = terms_of(j * pair.every);
      for (std::size_t k = 0; terms && k < terms->size(); ++k) {
        lanes[k][j % PointToLine::kLanes] = lanes[k][j % PointToLine::kLanes] + (*terms)[k];
      }
    }
    PointToLine::Sums totals{};
    for (std::size_t k = 0; k < totals.size(); ++k) totals[k] = sum_of(lanes[k]).value;
    return totals;
  }

  /// A point in the block of its scan that begins there; 2 * count farther on, its normal.
  [[nodiscard]] Arrow arrow(std::size_t first, std::size_t count, std::size_t i) const {
    return {Single{values[first + i]}, Single{values[first + count + i]}};
  }
  [[nodiscard]] Arrow line(std::size_t i) const { return arrow(pair.fixed, pair.fixed_count, i); }

  /// The number of the line of a point of the moving scan.
  [[nodiscard]] std::optional<std::size_t> line_of(std::size_t point) const {
    const Arrow there = placed(pair.found, arrow(pair.moving, pair.moving_count, point));
    const Single direction = direction_of(there);
    if (direction.value < pair.low || direction.value > pair.high) return std::nullopt;
    const Single bin = (direction + Single{2.0F}) * Single{64.0F};
    const std::int64_t first = bins[pair.bins + static_cast<std::size_t>(std::clamp(bin.value, 0.0F, 255.0F))];
    const std::int64_t last = std::int64_t{pair.fixed_count} - PointToLine::kCandidates;
    const auto start = static_cast<std::size_t>(std::clamp<std::int64_t>(first - PointToLine::kBefore, 0, last));
    std::uint32_t least = ~0U;
    for (std::uint32_t k = 0; k < PointToLine::kCandidates; ++k) {
      const Arrow away = line(start + k) - there;
      least = std::min(least, std::bit_cast<std::uint32_t>(dot(away, away).value) / 16 * 16 + k);
    }
    return least < std::bit_cast<std::uint32_t>(params.gate_m2) ? std::optional(start + least % 16) : std::nullopt;
  }

  /// What a point adds to the sums, if it is on a line.
  [[nodiscard]] std::optional<std::array<Single, PointToLine::kSums>> terms_of(std::size_t point) const {
    const std::optional<std::size_t> number = line_of(point);
    if (!number) return std::nullopt;
    const Arrow p = arrow(pair.moving, pair.moving_count, point);
    const Arrow own = arrow(pair.moving + 2 * std::size_t{pair.moving_count}, pair.moving_count, point);
    const Arrow n = arrow(pair.fixed + 2 * std::size_t{pair.fixed_count}, pair.fixed_count, *number);
    const Arrow j = turned_back(pair.at, n);
    if (dot(j, own).value < params.least_cosine) return std::nullopt;
    const Single off = dot(n, placed(pair.at, p) - line(*number));
    const Single jt = p.x * j.y - p.y * j.x;
    const Single share = reciprocal(Single{1.0F} + (off * off) * Single{params.per_kernel_m2});
    const Single w = share * share;
    const Arrow wj{w * j.x, w * j.y};
    const Single pull = w * off;
    return {{wj.x * j.x, wj.x * j.y, wj.x * jt, wj.y * j.y, wj.y * jt, (w * jt) * jt, pull * j.x, pull * j.y, pull * jt,
             w, pull * off}};
  }
};

}  // namespace

PointToLine::Sums brute_line_sums(const PointToLine::Params& params, const std::vector<float>& values,
                                  const std::vector<std::uint16_t>& bins, const PointToLine::Pair& pair) {
  return LinePair{params, values, bins, pair}.sums();
}

}  // namespace gdtslam::test
