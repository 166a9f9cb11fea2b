// The cost of a prior at a pose (engine/compute/kernels/pose_lattice/pose_lattice.hpp, PriorParams).
#ifndef GDTSLAM_PRIOR_GLSL
#define GDTSLAM_PRIOR_GLSL

struct Prior {
  vec3 mean;  // x, y, theta
  float weight_xy;
  float weight_theta;
  float limit;
};

uint prior_cost(Prior prior, vec3 pose) {
  precise float dx = pose.x - prior.mean.x;
  precise float dy = pose.y - prior.mean.y;
  precise float dt = pose.z - prior.mean.z;
  precise float shift = (dx * dx + dy * dy) * prior.weight_xy;
  precise float turn = (dt * dt) * prior.weight_theta;
  // Not min(), which may give either operand when one is NaN. A compiler that takes NaN for impossible may make a min of
  // the selects, of which it knows that the limit is a number; and one that drops the NaN gives the limit as well.
  precise float shift_cost = shift < prior.limit ? shift : prior.limit;
  precise float turn_cost = turn < prior.limit ? turn : prior.limit;
  precise float sum = shift_cost + turn_cost;
  return uint(sum);
}

#endif
