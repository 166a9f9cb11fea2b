#version 450
#extension GL_GOOGLE_include_directive : require
// Simplexes (gdtslam/compute/kernels/pose_simplex.hpp, PoseSimplex), points in a uniform buffer of at most 16 KiB.

layout(set = 0, binding = 1, std140) uniform Points { vec4 points[1024]; };  // two each

#define TWO_POINTS(i) points[i]
#define LAST_POINT(i) vec2(points[(i) / 2u][((i) & 1u) * 2u], points[(i) / 2u][((i) & 1u) * 2u + 1u])
#include "common/pose_simplex_narrow.glsl"
