// The lines of points and the sums over them against their definition in double, and to the bit between the instruction
// sets: with any number of points, strides, and points behind the robot and out of view.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/core/random.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

constexpr auto kFewest = static_cast<std::int32_t>(PointToLine::kCandidates);

/// A surface all around, its points in the order of their bearings.
struct AllAround {
  std::size_t count;
  std::vector<float> values;  // all x, all y, then the normals
  std::array<std::uint16_t, PointToLine::kBins> first{};

  AllAround(Random& random, std::uint32_t points) : count(points), values(std::size_t{4} * points) {
    for (std::size_t i = 0; i < count; ++i) {
      const double bearing = -3.1 + 6.2 * (static_cast<double>(i) + 0.5) / points;
      const double range_m = random.uniform(1.0, 4.0);
      const double normal = bearing + 3.14159265358979 + random.uniform(-0.5, 0.5);
      values[i] = static_cast<float>(range_m * std::cos(bearing));
      values[count + i] = static_cast<float>(range_m * std::sin(bearing));
      values[2 * count + i] = static_cast<float>(std::cos(normal));
      values[3 * count + i] = static_cast<float>(std::sin(normal));
    }
    for (std::size_t bin = 0; bin < first.size(); ++bin) {
      std::size_t at = 0;
      while (at < count && direction_of(x(at), y(at)) < static_cast<double>(bin) / 64.0 - 2.0) ++at;
      first[bin] = static_cast<std::uint16_t>(at);
    }
  }
  [[nodiscard]] double x(std::size_t i) const { return static_cast<double>(values[i]); }
  [[nodiscard]] double y(std::size_t i) const { return static_cast<double>(values[count + i]); }
  [[nodiscard]] double normal_x(std::size_t i) const { return static_cast<double>(values[2 * count + i]); }
  [[nodiscard]] double normal_y(std::size_t i) const { return static_cast<double>(values[3 * count + i]); }
  static double direction_of(double px, double py) {
    const double share = py / (std::fabs(px) + std::fabs(py));
    return px >= 0.0 ? share : (py >= 0.0 ? 2.0 : -2.0) - share;
  }
  [[nodiscard]] PointToLine::Scan seen_from(float low) const {
    return {values.data(), static_cast<std::uint32_t>(count), first.data(), low, 2.0F};
  }
};

struct Turned {
  double x = 0.0, y = 0.0;
};
Turned turned(const PointToLine::Pose& at, double x, double y) {
  const double s = at.sin;
  const double c = at.cos;
  return {c * x - s * y, s * x + c * y};
}

/// The nearest of the candidates, or none.
std::int32_t nearest(const AllAround& lines, float low, double gate_m, double px, double py) {
  const double direction = AllAround::direction_of(px, py);
  if (direction < static_cast<double>(low)) return PointToLine::kNone;
  const auto bin = static_cast<std::size_t>(std::clamp((direction + 2.0) * 64.0, 0.0, 255.0));
  const auto last = static_cast<std::int32_t>(lines.count) - kFewest;
  const std::int32_t start = std::clamp(lines.first[bin] - PointToLine::kBefore, 0, last);
  std::int32_t best = PointToLine::kNone;
  double least_m = gate_m;
  for (std::int32_t k = start; k < start + kFewest; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double away_m = std::hypot(lines.x(i) - px, lines.y(i) - py);
    if (away_m >= least_m) continue;
    least_m = away_m;
    best = k;
  }
  return best;
}

std::array<double, PointToLine::kSums> defined_sums(const AllAround& lines, const AllAround& points,
                                                    const PointToLine::Params& params, const PointToLine::Pose& at,
                                                    std::uint32_t every, const std::vector<std::int32_t>& found) {
  std::array<double, PointToLine::kSums> sums{};
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] == PointToLine::kNone) continue;
    const auto line = static_cast<std::size_t>(found[i]);
    const std::size_t point = i * every;
    const double px = points.x(point);
    const double py = points.y(point);
    const double nx = lines.normal_x(line);
    const double ny = lines.normal_y(line);
    const Turned there = turned(at, px, py);
    const Turned normal = turned(at, points.normal_x(point), points.normal_y(point));
    if (nx * normal.x + ny * normal.y < static_cast<double>(params.least_cosine)) continue;
    const double off = nx * (there.x + static_cast<double>(at.x) - lines.x(line)) +
                       ny * (there.y + static_cast<double>(at.y) - lines.y(line));
    const double s = at.sin;
    const double c = at.cos;
    const double jx = c * nx + s * ny;
    const double jy = c * ny - s * nx;
    const double jt = px * jy - py * jx;
    const double share = 1.0 / (1.0 + off * off * static_cast<double>(params.per_kernel_m2));
    const double w = share * share;
    const std::array terms{w * jx * jx,  w * jx * jy,  w * jx * jt,  w * jy * jy, w * jy * jt,  w * jt * jt,
                           w * off * jx, w * off * jy, w * off * jt, w,           w * off * off};
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += terms[k];
  }
  return sums;
}

TEST(PointsOnLines, AreThoseOfTheirDefinitionOnEveryInstructionSet) {
  Random random(21);
  const PointToLine::Params params{.gate_m2 = 0.16F, .per_kernel_m2 = 69.4F};
  int on_lines = 0;
  for (const std::uint32_t count : {16U, 17U, 45U, 128U, 129U, 300U}) {
    for (const std::uint32_t every : {1U, 3U}) {
      const AllAround lines(random, 200);
      const AllAround points(random, count);
      const double turn = random.uniform(-3.0, 3.0);
      const PointToLine::Pose at{.x = static_cast<float>(random.uniform(-0.5, 0.5)),
                                 .y = static_cast<float>(random.uniform(-0.5, 0.5)),
                                 .sin = static_cast<float>(std::sin(turn)),
                                 .cos = static_cast<float>(std::cos(turn))};
      const PointToLine::Scan fixed = lines.seen_from(-1.0F);
      const PointToLine::Scan moving = points.seen_from(-2.0F);
      std::vector<std::int32_t> first_found;
      PointToLine::Sums first_sums{};
      for (const Isa isa : available_isas()) {
        std::vector<std::int32_t> found((count + every - 1) / every);
        find_lines_host(isa, params, at, fixed, moving, every, found);
        const PointToLine::Sums sums = line_slope_host(isa, params, at, fixed, moving, every, found);
        if (isa == Isa::kBaseline) {
          for (std::size_t i = 0; i < found.size(); ++i) {
            const Turned there = turned(at, points.x(i * every), points.y(i * every));
            const std::int32_t expected = nearest(lines, fixed.low, 0.4, there.x + static_cast<double>(at.x),
                                                  there.y + static_cast<double>(at.y));
            EXPECT_EQ(found[i], expected) << "point " << i << " of " << count;
            on_lines += expected == PointToLine::kNone ? 0 : 1;
          }
          const auto expected = defined_sums(lines, points, params, at, every, found);
          for (std::size_t k = 0; k < sums.size(); ++k) {
            EXPECT_NEAR(static_cast<double>(sums[k]), expected[k], 1e-4 * (1.0 + std::fabs(expected[k]))) << k;
          }
          first_found = found;
          first_sums = sums;
        }
        EXPECT_EQ(found, first_found) << to_string(isa);
        EXPECT_EQ(sums, first_sums) << "to the bit, " << to_string(isa);
      }
    }
  }
  EXPECT_GT(on_lines, 100);
}

}  // namespace
}  // namespace gdtslam::test
