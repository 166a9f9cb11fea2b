// Cost of candidate poses, four an invocation: for CPUs as devices, where fetching a point takes as long as the arithmetic
// of a look-up. The points are in a uniform buffer and the field in texels, from which both come faster there.
#version 450
#extension GL_GOOGLE_include_directive : require
#define FIELD_IN_TEXELS
#include "common/launch.glsl"
#include "common/pose_cost.glsl"

layout(set = 0, binding = 1, std140) uniform Points { vec4 points[1024]; };  // two points an element

uvec4 terms(Context context[4], vec2 point) {
  return uvec4(term(context[0], point), term(context[1], point), term(context[2], point), term(context[3], point));
}

Context context_at(uint index) { return context_of(candidates[min(index, count - 1)]); }

void main() {
  uint first = linear_invocation() * 4;
  if (first >= count) {
    return;
  }
  Context context[4] =
      Context[](context_at(first), context_at(first + 1), context_at(first + 2), context_at(first + 3));
  uvec4 sum = uvec4(0);
  for (uint i = 0; i < point_count / 2; ++i) {
    vec4 two = points[i];
    sum += terms(context, two.xy) + terms(context, two.zw);
  }
  if ((point_count & 1u) == 1) {
    sum += terms(context, points[point_count / 2].xy);
  }
  for (uint i = 0; i < 4; ++i) {
    uint index = first + i;
    if (index < count) {
      cost[index] = saturating_sum(sum[i], candidates[index].bias);
    }
  }
}
