#version 450
#extension GL_GOOGLE_include_directive : require
// Simplexes (gdtslam/compute/kernels/pose_simplex.hpp, PoseSimplex), points in a storage buffer, the field in texels.

#define FIELD_IN_TEXELS
#include "common/pose_simplex_narrow.glsl"
