// The downhill simplex on the cost of a pose (engine/compute/kernels/pose_simplex/pose_simplex.hpp, PoseSimplex).
//
// The walk is one loop that costs one pose a turn and then decides what to cost next, so that invocations which stand at
// different moves of their walks still cost their poses together.
#ifndef GDTSLAM_SIMPLEX_GLSL
#define GDTSLAM_SIMPLEX_GLSL

struct Vertex {
  vec3 pose;
  uint cost;
};

// Purpose of the pose that is being costed.
const uint kFill = 0u;      // vertex `filled` of the simplex: first simplex, or shrunk
const uint kReflect = 1u;
const uint kExpand = 2u;
const uint kContract = 3u;

struct Walk {
  Vertex v0;  // sorted by cost between two moves
  Vertex v1;
  Vertex v2;
  Vertex v3;
  Vertex reflected;
  vec3 centre;
  vec3 trial;  // to be costed
  uint purpose;
  uint filled;
  uint evaluations;
  uint stop;  // 0: goes on
};

struct WalkLimits {
  float stop_cells;
  float stop_rad;
  uint max_evaluations;
};

Vertex chosen(bool first, Vertex a, Vertex b) {
  return Vertex(mix(b.pose, a.pose, bvec3(first)), first ? a.cost : b.cost);
}

/// from + factor * (to - from).
vec3 along(vec3 from, vec3 to, float factor) {
  precise vec3 result = from + factor * (to - from);
  return result;
}

void order(inout Vertex low, inout Vertex high) {
  bool swaps = high.cost < low.cost;
  Vertex lesser = chosen(swaps, high, low);
  high = chosen(swaps, low, high);
  low = lesser;
}

/// Exchanges of neighbours where the second is strictly lower: stable.
void sort_vertices(inout Walk walk) {
  order(walk.v0, walk.v1);
  order(walk.v1, walk.v2);
  order(walk.v0, walk.v1);
  order(walk.v2, walk.v3);
  order(walk.v1, walk.v2);
  order(walk.v0, walk.v1);
}

/// The larger one; NaN does not count.
vec3 larger_size(vec3 size, vec3 from, vec3 to) {
  precise vec3 reach = abs(to - from);
  return mix(size, reach, lessThan(size, reach));
}

bool is_small(Walk walk, WalkLimits limits) {
  vec3 size = larger_size(vec3(0.0), walk.v0.pose, walk.v1.pose);
  size = larger_size(size, walk.v0.pose, walk.v2.pose);
  size = larger_size(size, walk.v0.pose, walk.v3.pose);
  return size.x < limits.stop_cells && size.y < limits.stop_cells && size.z < limits.stop_rad;
}

Walk first_simplex(vec3 start, float step_cells, float step_rad) {
  precise vec3 along_all = start + vec3(step_cells, step_cells, step_rad);
  Walk walk;
  walk.v0 = Vertex(start, 0u);
  walk.v1 = Vertex(vec3(along_all.x, start.yz), 0u);
  walk.v2 = Vertex(vec3(start.x, along_all.y, start.z), 0u);
  walk.v3 = Vertex(vec3(start.xy, along_all.z), 0u);
  walk.reflected = walk.v0;
  walk.centre = start;
  walk.trial = start;
  walk.purpose = kFill;
  walk.filled = 0u;
  walk.evaluations = 0u;
  walk.stop = 0u;
  return walk;
}

/// After a move: sorts, and stops or reflects.
void next_move(inout Walk walk, WalkLimits limits) {
  sort_vertices(walk);
  bool small = is_small(walk, limits);
  walk.stop = small ? 1u : (walk.evaluations >= limits.max_evaluations ? 2u : 0u);
  precise vec3 centre = (walk.v0.pose + walk.v1.pose + walk.v2.pose) * (1.0 / 3.0);
  walk.centre = centre;
  walk.trial = along(centre, walk.v3.pose, -1.0);
  walk.purpose = kReflect;
}

void next_fill(inout Walk walk, uint place) {
  walk.filled = place;
  walk.trial = place == 0u ? walk.v0.pose : (place == 1u ? walk.v1.pose : (place == 2u ? walk.v2.pose : walk.v3.pose));
  walk.purpose = kFill;
}

/// Decides what follows from the cost of the trial pose.
void advance(inout Walk walk, uint cost, WalkLimits limits) {
  ++walk.evaluations;
  Vertex trial = Vertex(walk.trial, cost);
  bool moved = false;
  if (walk.purpose == kFill) {
    walk.v0.cost = walk.filled == 0u ? cost : walk.v0.cost;
    walk.v1.cost = walk.filled == 1u ? cost : walk.v1.cost;
    walk.v2.cost = walk.filled == 2u ? cost : walk.v2.cost;
    walk.v3.cost = walk.filled == 3u ? cost : walk.v3.cost;
    moved = walk.filled == 3u;
    next_fill(walk, walk.filled + 1u);
  } else if (walk.purpose == kReflect) {
    walk.reflected = trial;
    bool expands = cost < walk.v0.cost;
    moved = !expands && cost < walk.v2.cost;
    float factor = expands ? -2.0 : (cost < walk.v3.cost ? -0.5 : 0.5);
    walk.purpose = expands ? kExpand : kContract;
    walk.trial = along(walk.centre, walk.v3.pose, factor);
    walk.v3 = chosen(moved, trial, walk.v3);
  } else if (walk.purpose == kExpand) {
    walk.v3 = chosen(cost < walk.reflected.cost, trial, walk.reflected);
    moved = true;
  } else {
    moved = cost < min(walk.reflected.cost, walk.v3.cost);
    if (moved) {
      walk.v3 = trial;
    } else {
      walk.v1.pose = along(walk.v0.pose, walk.v1.pose, 0.5);
      walk.v2.pose = along(walk.v0.pose, walk.v2.pose, 0.5);
      walk.v3.pose = along(walk.v0.pose, walk.v3.pose, 0.5);
      next_fill(walk, 1u);
    }
  }
  if (moved) {
    next_move(walk, limits);
  }
}

#endif
