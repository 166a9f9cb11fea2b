#version 450
#extension GL_GOOGLE_include_directive : require
// Simplexes (gdtslam/compute/kernels/pose_simplex.hpp, PoseSimplex), points in a uniform buffer of at most 16 KiB.

#define POINTS_IN_UNIFORM
#include "common/pose_simplex_narrow.glsl"
