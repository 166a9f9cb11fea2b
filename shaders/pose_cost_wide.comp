// Cost of candidate poses, for large batches on GPUs: an invocation a candidate. The points are in a uniform buffer, for
// every invocation reads the same one at the same time.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/launch.glsl"
#include "common/pose_cost.glsl"

layout(set = 0, binding = 1, std140) uniform Points { vec4 points[1024]; };  // two points an element

void main() {
  uint index = linear_invocation();
  if (index >= count) {
    return;
  }
  Candidate candidate = candidates[index];
  Context context = context_of(candidate);
  uint sum = 0;
  for (uint i = 0; i < point_count / 2; ++i) {
    vec4 two = points[i];
    sum += term(context, two.xy) + term(context, two.zw);
  }
  if ((point_count & 1u) == 1) {
    sum += term(context, points[point_count / 2].xy);
  }
  cost[index] = saturating_sum(sum, candidate.bias);
}
