// Beams of nodding scans as points in space, paper equations (12) to (14). The sines are those of the shaders, compiled
// here for the current instruction set so that they process whole vectors of beams.

inline std::int32_t floatBitsToInt(float value) { return __builtin_bit_cast(std::int32_t, value); }
inline float intBitsToFloat(std::int32_t bits) { return __builtin_bit_cast(float, bits); }
#define precise
#include "elementary.glsl"
#undef precise

constexpr std::uint32_t kSweepTile = 256;

/// Ranges, elevations and directions of neighbouring beams of one strip.
struct SweepTile {
  alignas(64) float range[kSweepTile];
  alignas(64) float elevation[kSweepTile];
  alignas(64) float direction_x[kSweepTile];
  alignas(64) float direction_y[kSweepTile];
  alignas(64) float direction_z[kSweepTile];
};

/// +0 for values that are not finite or too small to matter.
inline float settled(float value) {
  const std::int32_t bits = floatBitsToInt(value);
  const std::int32_t size = bits & 0x7FFFFFFF;
  return intBitsToFloat(((size >= 0x2B800000) & (size < 0x7F800000)) ? bits : 0);
}

/// Elevations of `count` beams, the first of which has index `offset` in its strip. The look-ups are single loads
/// between two loops that become vector code.
void sweep_elevations(const BeamStrip& strip, std::uint32_t offset, std::uint32_t bits, const float* elevations,
                      std::uint32_t count, float* out) {
  alignas(64) std::uint32_t index[kSweepTile];
  alignas(64) float share[kSweepTile];
  alignas(64) float entry[kSweepTile];
  alignas(64) float next[kSweepTile];
  const std::uint32_t step = strip.phase_step;
  const std::uint32_t first = strip.phase + offset * step;
  const std::uint32_t shift = 31 - bits;  // and one more: a shift by 32 is undefined
  for (std::uint32_t n = 0; n < count; ++n) {
    const std::uint32_t phase = first + n * step;
    index[n] = (phase >> shift) >> 1U;
    share[n] = static_cast<float>(static_cast<std::int32_t>((phase << bits) >> 8U)) * 5.9604644775390625e-8F;  // 2^-24
  }
  for (std::uint32_t n = 0; n < count; ++n) {
    entry[n] = elevations[index[n]];
    next[n] = elevations[index[n] + 1];
  }
  for (std::uint32_t n = 0; n < count; ++n) {
    out[n] = settled(entry[n] + share[n] * (next[n] - entry[n]));
  }
}

/// Directions of the same beams.
void sweep_directions(const BeamStrip& strip, std::uint32_t offset, std::uint32_t directions, const float* direction,
                      std::uint32_t count, SweepTile& tile) {
  const std::uint32_t first = strip.first_direction + offset;
  float* __restrict x = tile.direction_x;
  float* __restrict y = tile.direction_y;
  float* __restrict z = tile.direction_z;
  if (first < directions && directions - first >= count) {
    const float* __restrict row = direction + 3 * static_cast<std::size_t>(first);
    for (std::size_t n = 0; n < count; ++n) {
      x[n] = row[3 * n];
      y[n] = row[3 * n + 1];
      z[n] = row[3 * n + 2];
    }
    return;
  }
  for (std::uint32_t n = 0; n < count; ++n) {
    const float* row = direction + 3 * static_cast<std::size_t>(lesser(first + n, directions - 1));
    x[n] = row[0];
    y[n] = row[1];
    z[n] = row[2];
  }
}

/// Equations (12) and (14) for these beams. Flattened: the loop becomes vector code only with the sines inlined.
template <bool kLiteral>
__attribute__((flatten)) void sweep_tile(const SweepPoints::Params& params, const BeamStrip& strip_in_table,
                                         std::uint32_t offset, const SweepTile& tile, std::uint32_t count,
                                         float* points) {
  const SweepPoints::Params p = params;
  const BeamStrip strip = strip_in_table;
  float* __restrict out = points;
  for (std::uint32_t n = 0; n < count; ++n) {
    const float range = tile.range[n];
    const float e = tile.elevation[n];
    const SinCosF32 nod = sin_cos_f32(e);
    const float qx = range * tile.direction_x[n] + p.lever_x_m;
    const float py = range * tile.direction_y[n];
    const float qz = range * tile.direction_z[n] + p.lever_z_m;
    const float px = (qx * nod.cos_value - qz * nod.sin_value) - p.lever_x_m;
    const float up = (qx * nod.sin_value + qz * nod.cos_value) - p.lever_z_m;
    const float pz = up + p.height_m;
    const auto k = static_cast<float>(static_cast<std::int32_t>((offset + n) & 0xFFFFFFU));
    const float x = strip.x_m + k * strip.x_step_m;
    const float y = strip.y_m + k * strip.y_step_m;
    const SinCosF32 turn = sin_cos_f32(strip.yaw_rad + k * strip.yaw_step_rad);
    const float mx = (px * turn.cos_value - py * turn.sin_value) + (kLiteral ? x * up : x);
    const float my = (px * turn.sin_value + py * turn.cos_value) + (kLiteral ? y * up : y);
    const float ox = (strip.outer_cos * mx - strip.outer_sin * my) + strip.outer_x_m;
    const float oy = (strip.outer_sin * mx + strip.outer_cos * my) + strip.outer_y_m;
    const std::int32_t infinity = 0x7F800000;
    const std::int32_t range_bits = floatBitsToInt(range);
    const bool is_point = (range_bits > 0) & (range_bits < infinity) & ((floatBitsToInt(ox) & infinity) != infinity) &
                          ((floatBitsToInt(oy) & infinity) != infinity) & ((floatBitsToInt(pz) & infinity) != infinity);
    const std::int32_t kept = -static_cast<std::int32_t>(is_point);
    out[4 * n] = intBitsToFloat(floatBitsToInt(settled(ox)) & kept);
    out[4 * n + 1] = intBitsToFloat(floatBitsToInt(settled(oy)) & kept);
    out[4 * n + 2] = intBitsToFloat(floatBitsToInt(settled(pz)) & kept);
    out[4 * n + 3] = e;
  }
}

void sweep_points(const SweepPoints::Params& params, const BeamRange* all_beams, const BeamStrip* strips,
                  const float* tables, float* points, Slice slice) {
  SweepTile tile;
  const float* directions = tables + (std::size_t{1} << params.table_bits) + 1;
  for (std::uint32_t first = slice.begin; first < slice.end;) {
    const BeamRange* beams = all_beams + first;
    const std::uint32_t most = lesser(slice.end - first, kSweepTile);
    const std::uint32_t named = beams[0].strip;
    std::uint32_t count = 0;
    for (; count < most && beams[count].strip == named; ++count) {
      tile.range[count] = beams[count].range_m;
    }
    const BeamStrip& strip = strips[lesser(named, params.strips - 1)];
    const std::uint32_t offset = first - strip.first_beam;
    sweep_elevations(strip, offset, params.table_bits, tables, count, tile.elevation);
    sweep_directions(strip, offset, params.directions, directions, count, tile);
    const auto run = params.form == SweepForm::kLiteral ? sweep_tile<true> : sweep_tile<false>;
    run(params, strip, offset, tile, count, points + 4 * static_cast<std::size_t>(first));
    first += count;
  }
}
