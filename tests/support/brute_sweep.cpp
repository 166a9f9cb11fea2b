#include "brute_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"

namespace gdtslam::test {
namespace {

constexpr std::uint64_t kTurn = 4294967296ULL;

/// A number of float32 whose operations are those of double, rounded once more: correctly rounded sums, differences and
/// products of two floats come out so, as 53 >= 2 * 24 + 2 bits.
struct Rounded {
  float value = 0.0F;
  [[nodiscard]] double wide() const { return static_cast<double>(value); }
};
Rounded rounded(double value) { return {static_cast<float>(value)}; }
Rounded operator+(Rounded a, Rounded b) { return rounded(a.wide() + b.wide()); }
Rounded operator-(Rounded a, Rounded b) { return rounded(a.wide() - b.wide()); }
Rounded operator*(Rounded a, Rounded b) { return rounded(a.wide() * b.wide()); }

Rounded settled(Rounded a) {
  const bool keeps = std::isfinite(a.value) && std::fabs(a.wide()) >= std::ldexp(1.0, -40);
  return keeps ? a : Rounded{};
}

/// A vector of the plane turned by the angle whose sine and cosine are given.
std::array<Rounded, 2> turned(std::array<Rounded, 2> v, Rounded sin, Rounded cos) {
  return {v[0] * cos - v[1] * sin, v[0] * sin + v[1] * cos};
}

std::array<Rounded, 2> turned(std::array<Rounded, 2> v, Rounded angle) {
  const SinCos<float> of = sin_cos(angle.value);
  return turned(v, Rounded{of.sin}, Rounded{of.cos});
}

Rounded elevation(const SweepInput& input, std::uint64_t phase) {
  const std::uint64_t cell = kTurn >> input.params.table_bits;
  const std::uint64_t index = phase / cell;
  const double share = std::floor(std::ldexp(static_cast<double>(phase % cell) / static_cast<double>(cell), 24));
  const Rounded low{input.tables[index]};
  const Rounded high{input.tables[index + 1]};
  return settled(low + rounded(std::ldexp(share, -24)) * (high - low));
}

}  // namespace

SweptPoint brute_sweep_point(const SweepInput& input, std::uint32_t beam) {
  const SweepPoints::Params& params = input.params;
  const BeamStrip& strip = input.strips[std::min<std::size_t>(input.beams[beam].strip, input.strips.size() - 1)];
  const std::uint64_t j = (kTurn + beam - strip.first_beam) % kTurn;
  const Rounded e = elevation(input, (strip.phase + (j * strip.phase_step) % kTurn) % kTurn);
  const Rounded range{input.beams[beam].range_m};
  if (!(range.value > 0.0F && std::isfinite(range.value))) {
    return {0.0F, 0.0F, 0.0F, e.value};
  }
  const std::uint64_t row =
      std::min<std::uint64_t>((strip.first_direction + j) % kTurn, std::uint64_t{params.directions} - 1);
  const std::size_t elevations = (kTurn >> (32 - params.table_bits)) + 1;
  const float* const direction = input.tables.data() + elevations + 3 * row;
  const Rounded lever_x{params.lever_x_m};
  const Rounded lever_z{params.lever_z_m};
  const std::array in_plane =
      turned({range * Rounded{direction[0]} + lever_x, range * Rounded{direction[2]} + lever_z}, e);
  const Rounded above_sensor = in_plane[1] - lever_z;
  const Rounded z = above_sensor + Rounded{params.height_m};

  const Rounded k{static_cast<float>(j % (1U << 24U))};
  const Rounded share = params.form == SweepForm::kLiteral ? above_sensor : Rounded{1.0F};
  const Rounded x = (Rounded{strip.x_m} + k * Rounded{strip.x_step_m}) * share;
  const Rounded y = (Rounded{strip.y_m} + k * Rounded{strip.y_step_m}) * share;
  const std::array inner = turned({in_plane[0] - lever_x, range * Rounded{direction[1]}},
                                  Rounded{strip.yaw_rad} + k * Rounded{strip.yaw_step_rad});
  const std::array outer = turned({inner[0] + x, inner[1] + y}, Rounded{strip.outer_sin}, Rounded{strip.outer_cos});
  const std::array<Rounded, 3> point{outer[0] + Rounded{strip.outer_x_m}, outer[1] + Rounded{strip.outer_y_m}, z};
  if (!std::all_of(point.begin(), point.end(), [](Rounded c) { return std::isfinite(c.value); })) {
    return {0.0F, 0.0F, 0.0F, e.value};
  }
  return {settled(point[0]).value, settled(point[1]).value, settled(point[2]).value, e.value};
}

}  // namespace gdtslam::test
