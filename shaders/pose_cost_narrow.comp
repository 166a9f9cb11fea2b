// Cost of candidate poses, four an invocation: for CPUs as devices, where fetching a point takes as long as the arithmetic
// of a look-up. The points are in a uniform buffer and the field in texels, from which both come faster there.
#version 450
#extension GL_GOOGLE_include_directive : require
#define FIELD_IN_TEXELS
#include "common/launch.glsl"
#include "common/pose_cost.glsl"

layout(set = 0, binding = 1, std140) uniform Points { vec4 points[1024]; };  // two points an element

uvec4 terms(Costing costing[4], vec2 point) {
  return uvec4(term(costing[0], point), term(costing[1], point), term(costing[2], point), term(costing[3], point));
}

Costing costing_at(uint index) { return costing_of(candidates[min(index, count - 1)]); }

void main() {
  uint first = linear_invocation() * 4;
  if (first >= count) {
    return;
  }
  Costing costing[4] =
      Costing[](costing_at(first), costing_at(first + 1), costing_at(first + 2), costing_at(first + 3));
  uvec4 sum = uvec4(0);
  for (uint i = 0; i < point_count / 2; ++i) {
    vec4 two = points[i];
    sum += terms(costing, two.xy) + terms(costing, two.zw);
  }
  if ((point_count & 1u) == 1) {
    sum += terms(costing, points[point_count / 2].xy);
  }
  for (uint i = 0; i < 4; ++i) {
    uint index = first + i;
    if (index < count) {
      cost[index] = saturating_add(sum[i], candidates[index].bias);
    }
  }
}
