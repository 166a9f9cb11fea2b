// The smallest values that an invocation has seen, by (value, index), in registers: no index below is variable, and the
// loops are written out, for not every compiler does it. The list has kMost places, of which the last `wanted` count;
// those before hold an entry that nothing precedes, so that the last place is always the one to beat.
#ifndef GDTSLAM_SMALLEST_LIST_GLSL
#define GDTSLAM_SMALLEST_LIST_GLSL

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

/// The smallest of the values first, first + step, ... below count, as many as the list has places at a time. VALUE(i)
/// is value i.
void collect_smallest(uint first, uint step_width, uint count) {
  for (uint begin = first; begin < count; begin += kMost * step_width) {
    uint block[kMost];
    uint least = kNoCost;
#define LOAD(j)                                         \
  {                                                     \
    uint i = begin + (j) * step_width;                  \
    uint value = VALUE(min(i, count - 1u));             \
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

#endif
