// The smallest cost and its index, the lowest index among equals. One work group: each invocation takes every n-th pair
// of quads, halves of the group then meet in shared memory. Pairs are compared by (cost, index), so their order is
// free.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/launch.glsl"

const uint kMostInvocations = 1024;
layout(push_constant) uniform Params { uint count; };
layout(set = 0, binding = 0, std430) readonly buffer Cost { uvec4 cost[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Result { uint result[2]; };
shared uvec2 best_of[kMostInvocations];  // cost, index

uvec2 lesser(uvec2 a, uvec2 b) {
  bool is_first = a.x < b.x || (a.x == b.x && a.y < b.y);
  return is_first ? a : b;
}

// Of a quad's costs, the last of which may lie beyond the end. A quad beyond the end has none.
uvec2 least_of_quad(uint quad) {
  uint quads = (count + 3) / 4;
  uvec4 costs = cost[min(quad, quads - 1)];
  uvec4 index = quad * 4 + uvec4(0, 1, 2, 3);
  costs = mix(uvec4(0xFFFFFFFFu), costs, lessThan(index, uvec4(count)));
  index = mix(uvec4(0xFFFFFFFFu), index, lessThan(index, uvec4(count)));
  return lesser(lesser(uvec2(costs.x, index.x), uvec2(costs.y, index.y)),
                lesser(uvec2(costs.z, index.z), uvec2(costs.w, index.w)));
}

void main() {
  uint own = gl_LocalInvocationID.x;
  uint size = gl_WorkGroupSize.x;
  uvec2 best = uvec2(0xFFFFFFFFu);
  for (uint quad = own; quad < (count + 3) / 4; quad += 2 * size) {
    best = lesser(best, lesser(least_of_quad(quad), least_of_quad(quad + size)));
  }
  best_of[own] = best;
  for (uint half_size = size / 2; half_size > 0; half_size /= 2) {
    barrier();
    if (own < half_size) {
      best_of[own] = lesser(best_of[own], best_of[own + half_size]);
    }
  }
  if (own == 0) {
    result[0] = best_of[0].x;
    result[1] = best_of[0].y;
  }
}
