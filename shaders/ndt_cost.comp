#version 450
#extension GL_GOOGLE_include_directive : require
// Scores of poses in a map of normal distributions (engine/compute/kernels/ndt_cost/ndt_cost.hpp), a work group a pose.
// The sum is of integers, so the order of its terms does not matter.

#include "common/launch.glsl"

// 64 words of four for the table, three for each distribution, then the numbers of the cubes' distributions.
layout(set = 0, binding = 0, std430) readonly buffer Map { uvec4 map[]; };
layout(set = 0, binding = 1, std430) readonly buffer Points { float points[]; };  // three each
layout(set = 0, binding = 2, std430) readonly buffer Poses { vec4 poses[]; };     // three each
layout(set = 0, binding = 3, std430) writeonly buffer Scores { uint scores[]; };

layout(push_constant) uniform Params {
  uint point_count;
  uint size_x;
  uint size_y;
  uint size_z;
  uint distribution_count;
  float origin_x_m;
  float origin_y_m;
  float origin_z_m;
  float cubes_per_m;
  float steps_per_unit;
  uint count;  // number of poses, from the launch
} params;

const uint kTable = 64u;  // words of four
const uint kNoCube = 0xFFFFFFFFu;
const float kFarthest = 1073741824.0;
const uint kMostInvocations = 256u;

shared uint sum_of[kMostInvocations];

struct Pose {
  vec3 row_x;
  vec3 row_y;
  vec3 row_z;
  vec3 translation;  // in the frame of the box
};

Pose pose_at(uint index) {
  vec4 a = poses[3u * index];
  vec4 b = poses[3u * index + 1u];
  vec4 c = poses[3u * index + 2u];
  precise float x = c.y - params.origin_x_m;
  precise float y = c.z - params.origin_y_m;
  precise float z = c.w - params.origin_z_m;
  return Pose(a.xyz, vec3(a.w, b.xy), vec3(b.zw, c.x), vec3(x, y, z));
}

float along(vec3 row, vec3 point, float translation) {
  precise float place = ((row.x * point.x + row.y * point.y) + row.z * point.z) + translation;
  return place;
}

uint cube_along(float place) {
  precise float counted = place * params.cubes_per_m + 1.0;
  float above = counted > 0.0 ? counted : 0.0;
  return uint(int(above < kFarthest ? above : kFarthest)) - 1u;
}

uint cube_of(vec3 place) {
  uint x = cube_along(place.x);
  uint y = cube_along(place.y);
  uint z = cube_along(place.z);
  bool is_in_box = x < params.size_x && y < params.size_y && z < params.size_z;
  return is_in_box ? (z * params.size_y + y) * params.size_x + x : kNoCube;
}

uint step_of(uint distribution, vec3 place) {
  uint at = kTable + 3u * distribution;
  vec4 a = uintBitsToFloat(map[at]);       // mean x, y, z, information xx
  vec4 b = uintBitsToFloat(map[at + 1u]);  // xy, xz, yy, yz
  float zz = uintBitsToFloat(map[at + 2u].x);
  precise float dx = place.x - a.x;
  precise float dy = place.y - a.y;
  precise float dz = place.z - a.z;
  precise float mixed_x = b.x * dy + b.y * dz;
  precise float mixed_y = b.w * dz;
  precise float u = a.w * dx + (mixed_x + mixed_x);
  precise float v = b.z * dy + (mixed_y + mixed_y);
  precise float q = (u * dx + v * dy) + (zz * dz) * dz;
  precise float steps = q * params.steps_per_unit;
  float below = steps < 255.0 ? steps : 255.0;
  return min(uint(int(below > 0.0 ? below : 0.0)), 255u);
}

uint score_of(Pose pose, uint point) {
  vec3 p = vec3(points[3u * point], points[3u * point + 1u], points[3u * point + 2u]);
  vec3 place = vec3(along(pose.row_x, p, pose.translation.x), along(pose.row_y, p, pose.translation.y),
                    along(pose.row_z, p, pose.translation.z));
  uint cube = cube_of(place);
  if (cube == kNoCube) return 0u;
  uint distribution = map[kTable + 3u * params.distribution_count + (cube >> 2)][cube & 3u];
  if (distribution >= params.distribution_count) return 0u;
  uint at = step_of(distribution, place);
  return map[at >> 2][at & 3u];
}

void main() {
  uint index = linear_group();
  if (index >= params.count) {
    return;  // the whole group
  }
  uint own = gl_LocalInvocationID.x;
  Pose pose = pose_at(index);
  uint sum = 0u;
  for (uint point = own; point < params.point_count; point += gl_WorkGroupSize.x) sum += score_of(pose, point);
  sum_of[own] = sum;
  for (uint half_size = gl_WorkGroupSize.x / 2u; half_size > 0u; half_size /= 2u) {
    barrier();
    if (own < half_size) sum_of[own] += sum_of[own + half_size];
  }
  if (own == 0u) scores[index] = sum_of[0];
}
