#version 450
#extension GL_GOOGLE_include_directive : require
// The smallest values (engine/compute/kernels/pose_lattice/pose_lattice.hpp, SmallestValues): one group. The lists of
// its invocations are merged by runs, then the runs' lists by the first of them; a merge gives one entry a round.

layout(set = 0, binding = 0, std430) readonly buffer Values { uint values[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Picks { uvec2 picks[]; };  // value, index

layout(push_constant) uniform Params {
  uint count;
  uint wanted;
} params;

#include "common/launch.glsl"

// The smallest values that an invocation has seen, by (value, index), in registers: no index below is variable, and the
// loops are written out, for not every compiler does it. The list has kMost places, of which the last `wanted` count;
// those before hold an entry that nothing precedes, so that the last place is always the one to beat.
const uint kNoCost = 0xFFFFFFFFu;
const uint kMost = 16u;  // SmallestValues::kMost

#define FOR_EACH_PLACE(STEP) \
  STEP(0u) STEP(1u) STEP(2u) STEP(3u) STEP(4u) STEP(5u) STEP(6u) STEP(7u) \
  STEP(8u) STEP(9u) STEP(10u) STEP(11u) STEP(12u) STEP(13u) STEP(14u) STEP(15u)
#define FOR_EACH_PLACE_BUT_FIRST_DOWN(STEP) \
  STEP(15u) STEP(14u) STEP(13u) STEP(12u) STEP(11u) STEP(10u) STEP(9u) STEP(8u) \
  STEP(7u) STEP(6u) STEP(5u) STEP(4u) STEP(3u) STEP(2u) STEP(1u)

uvec2 list[kMost];  // value, index

void clear_list(uint wanted) {
#define CLEAR(i) list[i] = (i) >= kMost - wanted ? uvec2(kNoCost) : uvec2(0u);
  FOR_EACH_PLACE(CLEAR)
}

/// Puts an entry into its place, behind equal values, for they have lower indices; drops it where the list is better.
void insert_small(uvec2 entry) {
#define SHIFT_OR_PLACE(i) \
  list[i] = entry.x < list[(i)-1u].x ? list[(i)-1u] : (entry.x < list[i].x ? entry : list[i]);
  FOR_EACH_PLACE_BUT_FIRST_DOWN(SHIFT_OR_PLACE)
  list[0] = entry.x < list[0].x ? entry : list[0];
}

/// The smallest of the values first, first + step, ... below count, as many as the list has places at a time.
void collect_smallest(uint first, uint step_width, uint count) {
  for (uint begin = first; begin < count; begin += kMost * step_width) {
    uint block[kMost];
    uint least = kNoCost;
#define LOAD(j)                                         \
  {                                                     \
    uint i = begin + (j) * step_width;                  \
    uint value = values[min(i, count - 1u)];            \
    block[j] = i < count ? value : kNoCost;             \
    least = min(least, block[j]);                       \
  }
    FOR_EACH_PLACE(LOAD)
    // Rarely does anything enter the list. A loop and not a condition, because CPUs that run invocations in lockstep
    // go through what is conditional, but leave out a loop that nobody enters.
    while (least < list[kMost - 1u].x) {
#define INSERT(j) insert_small(uvec2(block[j], begin + (j) * step_width));
      FOR_EACH_PLACE(INSERT)
      least = kNoCost;
    }
  }
}

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
    drop_head();  // drops what stands before the entries that count
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
  for (uint i = self; i < params.wanted; i += gl_WorkGroupSize.x) {
    picks[i] = uvec2(run_value[i], run_index[i]);
  }
}
