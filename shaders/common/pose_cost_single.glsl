// pose_cost with an invocation a candidate. The includer defines POINTS, the declaration of the points' buffer up to
// its name, and MOST_ELEMENTS, its length.
#include "common/launch.glsl"
#include "common/pose_cost.glsl"

layout(set = 0, binding = 1) POINTS { vec4 points[MOST_ELEMENTS]; };  // two points an element

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
