#version 450
#extension GL_GOOGLE_include_directive : require
// Local minima of a window's costs (engine/compute/kernels/pose_lattice/pose_lattice.hpp, LatticeMinima).
//
// An invocation walks along a piece of a row. Of each column of nine samples it looks at once it keeps the least cost
// among those of lower and those of higher index than the middle one; three such columns decide about a sample.

const uint kPiece = 4u;  // samples of an invocation

layout(set = 0, binding = 0, std430) readonly buffer Cost { uint cost[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Minima { uint minima[]; };

layout(push_constant) uniform Params {
  uint count_xy;
  uint count_theta;
} params;

#include "common/launch.glsl"

const uint kNoCost = 0xFFFFFFFFu;

// The samples beside a row at one x; kNoCost, which beats nothing, where there is none.
struct Column {
  uint before;  // least of those of lower index in other rows
  uint after;   // and of those of higher index
  uint own;     // in the row itself
};

// Which rows around a row there are, and where they begin relative to it.
struct Neighbourhood {
  uint row_start;
  bool below;    // y - 1
  bool above;    // y + 1
  bool earlier;  // theta - 1
  bool later;    // theta + 1
};

uint sample_cost(bool exists, uint index) {
  // Index 0 always exists: the load is done by all, and the result chosen.
  uint value = cost[exists ? index : 0u];
  return exists ? value : kNoCost;
}

Column column_at(Neighbourhood near, uint x, bool exists) {
  uint n = params.count_xy;
  uint layer = n * n;
  uint here = near.row_start + x;
  bool earlier = exists && near.earlier;
  bool later = exists && near.later;
  Column column;
  column.own = sample_cost(exists, here);
  column.before = sample_cost(exists && near.below, here - n);
  column.after = sample_cost(exists && near.above, here + n);
  column.before = min(column.before, sample_cost(earlier && near.below, here - layer - n));
  column.before = min(column.before, sample_cost(earlier, here - layer));
  column.before = min(column.before, sample_cost(earlier && near.above, here - layer + n));
  column.after = min(column.after, sample_cost(later && near.below, here + layer - n));
  column.after = min(column.after, sample_cost(later, here + layer));
  column.after = min(column.after, sample_cost(later && near.above, here + layer + n));
  return column;
}

void main() {
  uint n = params.count_xy;
  uint pieces = (n + kPiece - 1u) / kPiece;
  uint place = linear_invocation();
  uint row = place / pieces;
  if (row >= n * params.count_theta) {
    return;
  }
  uint t = row / n;
  uint y = row - t * n;
  uint begin = (place - row * pieces) * kPiece;
  uint end = min(begin + kPiece, n);
  Neighbourhood near = Neighbourhood(row * n, y > 0u, y + 1u < n, t > 0u, t + 1u < params.count_theta);

  Column left = column_at(near, begin - 1u, begin > 0u);
  Column middle = column_at(near, begin, true);
  for (uint x = begin; x < end; ++x) {
    Column right = column_at(near, x + 1u, x + 1u < n);
    uint before = min(min(left.before, middle.before), min(right.before, left.own));
    uint after = min(min(left.after, middle.after), min(right.after, right.own));
    bool stays = middle.own < before && middle.own <= after;
    minima[near.row_start + x] = stays ? middle.own : kNoCost;
    left = middle;
    middle = right;
  }
}
