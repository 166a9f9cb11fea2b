#version 450
#extension GL_GOOGLE_include_directive : require
// The smallest values (gdtslam/compute/kernels/pose_lattice.hpp, SmallestValues): one group of many invocations. Their
// lists are merged by runs, then the runs' lists by the first of them; a merge gives one entry a round.

layout(set = 0, binding = 0, std430) readonly buffer Values { uint values[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Picks { uvec2 picks[]; };  // value, index

layout(push_constant) uniform Params {
  uint count;
  uint wanted;
} params;

#define VALUE(i) values[i]
#include "common/launch.glsl"
#include "common/smallest_list.glsl"

const uint kRun = 32u;  // invocations that merge their lists in the first step
const uint kRuns = (gl_WorkGroupSize.x + kRun - 1u) / kRun;

shared uint run_value[kRuns * kMost];
shared uint run_index[kRuns * kMost];

void drop_head() {
#define TAKE_NEXT(i) list[i] = (i) + 1u < kMost ? list[min((i) + 1u, kMost - 1u)] : uvec2(kNoCost);
  FOR_EACH_PLACE(TAKE_NEXT)
}

/// Leaves the smallest entries of a run's lists, whose heads are in place 0, in shared memory.
void merge_run(uint run) {
  for (uint i = gl_LocalInvocationID.x; i < kRuns * kMost; i += gl_WorkGroupSize.x) {
    run_value[i] = kNoCost;
    run_index[i] = kNoCost;
  }
  barrier();
  for (uint pick = 0u; pick < params.wanted; ++pick) {
    uint slot = run * kMost + pick;
    atomicMin(run_value[slot], list[0].x);
    barrier();
    bool ties = list[0].x == run_value[slot];
    if (ties) {
      atomicMin(run_index[slot], list[0].y);
    }
    barrier();
    if (ties && list[0].y == run_index[slot]) {
      drop_head();
    }
  }
}

void main() {
  uint self = gl_LocalInvocationID.x;
  clear_list(params.wanted);
  collect_smallest(self, gl_WorkGroupSize.x, params.count);
  for (uint i = params.wanted; i < kMost; ++i) {
    drop_head();  // what stands before the entries that count
  }
  merge_run(self / kRun);
  uint run = min(self, kRuns - 1u);
#define TAKE(i)                                                                          \
  list[i] = self < kRuns && (i) < params.wanted                                          \
                ? uvec2(run_value[run * kMost + (i)], run_index[run * kMost + (i)])      \
                : uvec2(kNoCost);
  FOR_EACH_PLACE(TAKE)
  barrier();
  merge_run(0u);
  if (self < params.wanted) {
    picks[self] = uvec2(run_value[self], run_index[self]);
  }
}
