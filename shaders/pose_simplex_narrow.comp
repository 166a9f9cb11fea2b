#version 450
#extension GL_GOOGLE_include_directive : require
// Simplexes (gdtslam/compute/kernels/pose_simplex.hpp, PoseSimplex), points in a storage buffer.

layout(set = 0, binding = 1, std430) readonly buffer Points { vec2 points[]; };

#define TWO_POINTS(i) vec4(points[2u * (i)], points[2u * (i) + 1u])
#define LAST_POINT(i) points[i]
#include "common/pose_simplex_narrow.glsl"
