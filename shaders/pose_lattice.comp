#version 450
#extension GL_GOOGLE_include_directive : require
// The samples of a window (engine/compute/kernels/pose_lattice/pose_lattice.hpp, PoseLattice).

layout(set = 0, binding = 0, std430) writeonly buffer Candidates { uvec4 candidates[]; };

layout(push_constant) uniform Params {
  float centre_x;
  float centre_y;
  float centre_theta;
  float step_cells;
  float step_rad;
  uint count_xy;
  uint count_theta;
  float mean_x;
  float mean_y;
  float mean_theta;
  float weight_xy;
  float weight_theta;
  float limit;
} params;

#include "common/launch.glsl"
#include "common/prior.glsl"

float coordinate(float centre, uint i, uint count, float step_width) {
  precise float offset = (float(i) - float(count / 2u)) * step_width;
  precise float result = centre + offset;
  return result;
}

void main() {
  uint n = params.count_xy;
  uint count = n * n * params.count_theta;
  uint i = linear_invocation();
  if (i >= count) {
    return;
  }
  Prior prior = Prior(vec3(params.mean_x, params.mean_y, params.mean_theta), params.weight_xy, params.weight_theta,
                      params.limit);
  uint row = i / n;
  vec3 pose = vec3(coordinate(params.centre_x, i - row * n, n, params.step_cells),
                   coordinate(params.centre_y, row % n, n, params.step_cells),
                   coordinate(params.centre_theta, row / n, params.count_theta, params.step_rad));
  candidates[i] = uvec4(floatBitsToUint(pose), prior_cost(prior, pose));
}
