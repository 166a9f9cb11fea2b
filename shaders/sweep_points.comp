#version 450
#extension GL_GOOGLE_include_directive : require
// Beams of nodding scans as points in space (engine/compute/kernels/sweep_points/sweep_points.hpp).

#include "common/elementary.glsl"
#include "common/launch.glsl"

struct BeamStrip {
  uint first_beam;
  uint first_direction;
  uint phase;
  uint phase_step;
  float x;
  float y;
  float yaw;
  float x_step;
  float y_step;
  float yaw_step;
  float outer_x;
  float outer_y;
  float outer_cos;
  float outer_sin;
  uint unused_0;
  uint unused_1;
};

layout(set = 0, binding = 0, std430) readonly buffer Beams { uvec2 beams[]; };  // range, strip
layout(set = 0, binding = 1, std430) readonly buffer Strips { BeamStrip strips[]; };
layout(set = 0, binding = 2, std430) readonly buffer Tables { float tables[]; };  // elevations, directions
layout(set = 0, binding = 3, std430) writeonly buffer Points { uvec4 points[]; };

layout(push_constant) uniform Params {
  uint beams;
  uint strips;
  uint directions;
  uint table_bits;
  float lever_x;
  float lever_z;
  float height;
  uint form;  // 0 working, 1 literal
} params;

const uint kInfinity = 0x7F800000u;

// The bits of a value, 0 for what is not finite or too small to matter.
uint settled(float value) {
  uint bits = floatBitsToUint(value);
  uint size = bits & 0x7FFFFFFFu;
  return size >= 0x2B800000u && size < kInfinity ? bits : 0u;
}

bool is_finite(float value) { return (floatBitsToUint(value) & kInfinity) != kInfinity; }

float elevation_at(uint phase) {
  uint index = (phase >> (31u - params.table_bits)) >> 1u;
  precise float share = float((phase << params.table_bits) >> 8u) * 5.9604644775390625e-8f;
  float entry = tables[index];
  precise float rise = tables[index + 1u] - entry;
  precise float elevation = entry + share * rise;
  return uintBitsToFloat(settled(elevation));
}

vec3 direction_at(uint row) {
  uint at = (1u << params.table_bits) + 1u + 3u * (row < params.directions ? row : params.directions - 1u);
  return vec3(tables[at], tables[at + 1u], tables[at + 2u]);
}

// Equation (12).
vec3 in_base(float range, vec3 direction, SinCosF32 nod, out float above_sensor) {
  precise float qx = range * direction.x + params.lever_x;
  precise float py = range * direction.y;
  precise float qz = range * direction.z + params.lever_z;
  precise float px = (qx * nod.cos_value - qz * nod.sin_value) - params.lever_x;
  precise float up = (qx * nod.sin_value + qz * nod.cos_value) - params.lever_z;
  precise float pz = up + params.height;
  above_sensor = up;
  return vec3(px, py, pz);
}

// Equation (14), the pose at beam number k of the strip.
vec3 in_map(vec3 p, float above_sensor, uint strip, float k) {
  precise float x = strips[strip].x + k * strips[strip].x_step;
  precise float y = strips[strip].y + k * strips[strip].y_step;
  precise float yaw = strips[strip].yaw + k * strips[strip].yaw_step;
  if (params.form == 1u) {
    precise float scaled_x = x * above_sensor;
    precise float scaled_y = y * above_sensor;
    x = scaled_x;
    y = scaled_y;
  }
  SinCosF32 turn = sin_cos_f32(yaw);
  precise float mx = (p.x * turn.cos_value - p.y * turn.sin_value) + x;
  precise float my = (p.x * turn.sin_value + p.y * turn.cos_value) + y;
  float c = strips[strip].outer_cos;
  float s = strips[strip].outer_sin;
  precise float ox = (c * mx - s * my) + strips[strip].outer_x;
  precise float oy = (s * mx + c * my) + strips[strip].outer_y;
  return vec3(ox, oy, p.z);
}

void main() {
  uint beam = linear_invocation();
  if (beam >= params.beams) {
    return;
  }
  uint range_bits = beams[beam].x;
  uint strip = beams[beam].y;
  strip = strip < params.strips ? strip : params.strips - 1u;
  uint offset = beam - strips[strip].first_beam;
  float elevation = elevation_at(strips[strip].phase + offset * strips[strip].phase_step);
  vec3 direction = direction_at(strips[strip].first_direction + offset);
  float above_sensor;
  vec3 p = in_base(uintBitsToFloat(range_bits), direction, sin_cos_f32(elevation), above_sensor);
  vec3 m = in_map(p, above_sensor, strip, float(offset & 0xFFFFFFu));
  bool is_point =
      range_bits > 0u && range_bits < kInfinity && is_finite(m.x) && is_finite(m.y) && is_finite(m.z);
  uvec3 place = is_point ? uvec3(settled(m.x), settled(m.y), settled(m.z)) : uvec3(0u);
  points[beam] = uvec4(place, floatBitsToUint(elevation));
}
