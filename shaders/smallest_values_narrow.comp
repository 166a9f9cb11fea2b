#version 450
#extension GL_GOOGLE_include_directive : require
// The smallest values (gdtslam/compute/kernels/pose_lattice.hpp, SmallestValues): one group of few invocations, whose
// lists one of them merges. For CPUs as devices, where a barrier costs more than the merge.

layout(set = 0, binding = 0, std430) readonly buffer Values { uint values[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Picks { uvec2 picks[]; };  // value, index

layout(push_constant) uniform Params {
  uint count;
  uint wanted;
} params;

#define VALUE(i) values[i]
#include "common/launch.glsl"
#include "common/smallest_list.glsl"

shared uvec2 lists[gl_WorkGroupSize.x * kMost];
shared uint heads[gl_WorkGroupSize.x];

bool precedes(uvec2 a, uvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

void main() {
  uint self = gl_LocalInvocationID.x;
  clear_list(params.wanted);
  collect_smallest(self, gl_WorkGroupSize.x, params.count);
#define SHARE(i) lists[self * kMost + i] = list[i];
  FOR_EACH_PLACE(SHARE)
  heads[self] = kMost - params.wanted;
  barrier();
  if (self == 0u) {
    for (uint pick = 0u; pick < params.wanted; ++pick) {
      uint owner = 0u;
      uvec2 best = lists[heads[0]];
      for (uint other = 1u; other < gl_WorkGroupSize.x; ++other) {
        uvec2 entry = lists[other * kMost + heads[other]];
        bool better = precedes(entry, best);
        owner = better ? other : owner;
        best = better ? entry : best;
      }
      picks[pick] = best;
      ++heads[owner];
    }
  }
}
