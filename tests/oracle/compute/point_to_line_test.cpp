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
  std::vector<PointToLine::Point> points;
  std::vector<float> x, y;
  std::array<std::uint16_t, PointToLine::kBins> first{};

  AllAround(Random& random, std::int32_t count) {
    for (std::int32_t i = 0; i < count; ++i) {
      const double bearing = -3.1 + 6.2 * (i + 0.5) / count;
      const double range_m = random.uniform(1.0, 4.0);
      const double normal = bearing + 3.14159265358979 + random.uniform(-0.5, 0.5);
      x.push_back(static_cast<float>(range_m * std::cos(bearing)));
      y.push_back(static_cast<float>(range_m * std::sin(bearing)));
      points.push_back(
          {x.back(), y.back(), static_cast<float>(std::cos(normal)), static_cast<float>(std::sin(normal))});
    }
    for (std::size_t bin = 0; bin < first.size(); ++bin) {
      std::size_t at = 0;
      while (at < x.size() && direction(at) < static_cast<double>(bin) / 64.0 - 2.0) ++at;
      first[bin] = static_cast<std::uint16_t>(at);
    }
  }
  [[nodiscard]] double direction(std::size_t i) const { return direction_of(x[i], y[i]); }
  static double direction_of(double px, double py) {
    const double share = py / (std::fabs(px) + std::fabs(py));
    return px >= 0.0 ? share : (py >= 0.0 ? 2.0 : -2.0) - share;
  }
  [[nodiscard]] PointToLine::Lines seen_from(float low) const {
    return {points.data(), x.data(), y.data(), static_cast<std::int32_t>(x.size()), first.data(), low, 2.0F};
  }
};

struct Turned {
  double x = 0.0, y = 0.0;
};
Turned turned(const PointToLine::Params& at, double x, double y) {
  const double s = at.sin;
  const double c = at.cos;
  return {c * x - s * y, s * x + c * y};
}

/// The nearest of the candidates, or none.
std::int32_t nearest(const AllAround& lines, float low, double gate_m, double px, double py) {
  const double direction = AllAround::direction_of(px, py);
  if (direction < static_cast<double>(low)) return PointToLine::kNone;
  const auto bin = static_cast<std::size_t>(std::clamp((direction + 2.0) * 64.0, 0.0, 255.0));
  const auto last = static_cast<std::int32_t>(lines.x.size()) - kFewest;
  const std::int32_t start = std::clamp(lines.first[bin] - PointToLine::kBefore, 0, last);
  std::int32_t best = PointToLine::kNone;
  double least_m = gate_m;
  for (std::int32_t k = start; k < start + kFewest; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double away_m = std::hypot(static_cast<double>(lines.x[i]) - px, static_cast<double>(lines.y[i]) - py);
    if (away_m >= least_m) continue;
    least_m = away_m;
    best = k;
  }
  return best;
}

PointToLine::Sums defined_sums(const AllAround& lines, const AllAround& points, const PointToLine::Params& at,
                               const std::vector<std::int32_t>& found) {
  PointToLine::Sums sums{};
  for (std::uint32_t i = 0; i < at.point_count; ++i) {
    if (found[i] == PointToLine::kNone) continue;
    const auto line = static_cast<std::size_t>(found[i]);
    const std::size_t point = static_cast<std::size_t>(i) * at.every;
    const double px = points.x[point];
    const double py = points.y[point];
    const double nx = lines.points[line].normal_x;
    const double ny = lines.points[line].normal_y;
    const Turned there = turned(at, px, py);
    const Turned normal = turned(at, points.points[point].normal_x, points.points[point].normal_y);
    if (nx * normal.x + ny * normal.y < static_cast<double>(at.least_cosine)) continue;
    const double off = nx * (there.x + static_cast<double>(at.x) - static_cast<double>(lines.x[line])) +
                       ny * (there.y + static_cast<double>(at.y) - static_cast<double>(lines.y[line]));
    const double s = at.sin;
    const double c = at.cos;
    const double jx = c * nx + s * ny;
    const double jy = c * ny - s * nx;
    const double jt = px * jy - py * jx;
    const double share = 1.0 / (1.0 + off * off / std::pow(static_cast<double>(at.kernel_m), 2.0));
    const double w = share * share;
    const PointToLine::Sums terms{w * jx * jx,  w * jx * jy,  w * jx * jt,  w * jy * jy, w * jy * jt,  w * jt * jt,
                                  w * off * jx, w * off * jy, w * off * jt, w,           w * off * off};
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += terms[k];
  }
  return sums;
}

TEST(PointsOnLines, AreThoseOfTheirDefinitionOnEveryInstructionSet) {
  Random random(21);
  int on_lines = 0;
  for (const std::int32_t count : {16, 17, 45, 128, 129, 300}) {
    for (const std::uint32_t every : {1U, 3U}) {
      const AllAround lines(random, 200);
      const AllAround points(random, count);
      const double turn = random.uniform(-3.0, 3.0);
      const PointToLine::Params at{.x = static_cast<float>(random.uniform(-0.5, 0.5)),
                                   .y = static_cast<float>(random.uniform(-0.5, 0.5)),
                                   .sin = static_cast<float>(std::sin(turn)),
                                   .cos = static_cast<float>(std::cos(turn)),
                                   .gate_m = 0.4F,
                                   .kernel_m = 0.12F,
                                   .every = every,
                                   .point_count = (static_cast<std::uint32_t>(count) + every - 1) / every};
      const float low = -1.0F;
      const PointToLine::Lines of_scan = lines.seen_from(low);
      std::vector<std::int32_t> first_found;
      PointToLine::Sums first_sums{};
      for (const Isa isa : available_isas()) {
        std::vector<std::int32_t> found(at.point_count);
        find_lines_host(isa, at, of_scan, points.points.data(), found.data());
        const PointToLine::Sums sums = line_slope_host(isa, at, of_scan, points.points.data(), found.data());
        if (isa == Isa::kBaseline) {
          for (std::uint32_t i = 0; i < at.point_count; ++i) {
            const std::size_t point = static_cast<std::size_t>(i) * every;
            const Turned there = turned(at, points.x[point], points.y[point]);
            const std::int32_t expected =
                nearest(lines, low, 0.4, there.x + static_cast<double>(at.x), there.y + static_cast<double>(at.y));
            EXPECT_EQ(found[i], expected) << "point " << i << " of " << count;
            on_lines += expected == PointToLine::kNone ? 0 : 1;
          }
          const PointToLine::Sums expected = defined_sums(lines, points, at, found);
          for (std::size_t k = 0; k < sums.size(); ++k) {
            EXPECT_NEAR(sums[k], expected[k], 1e-5 * (1.0 + std::fabs(expected[k]))) << k << " of " << count;
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
