#version 450
#extension GL_GOOGLE_include_directive : require
// Start poses of the simplexes (engine/compute/kernels/pose_simplex/pose_simplex.hpp, PoseStarts).

#include "common/launch.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Candidates { uvec4 candidates[]; };
layout(set = 0, binding = 1, std430) readonly buffer Picks { uvec2 picks[]; };   // value, index
layout(set = 0, binding = 2, std430) writeonly buffer Poses { uvec4 poses[]; };  // two a pose

layout(push_constant) uniform Params {
  float x;
  float y;
  float theta;
  uint candidate_count;
  uint count;  // number of starts, from the launch
} params;

void main() {
  uint start = linear_invocation();
  if (start >= params.count) {
    return;
  }
  uvec3 pose = floatBitsToUint(vec3(params.x, params.y, params.theta));
  if (start > 0u) {
    uint index = picks[start - 1u].y;
    if (index < params.candidate_count) {
      pose = candidates[index].xyz;
    }
  }
  poses[2u * start] = uvec4(pose, 0u);
  poses[2u * start + 1u] = uvec4(0u);
}
