// Bounds of tiles of boxes on CPUs as devices, the points in a uniform buffer and the field in texels, from which they come
// faster.
#version 450
#extension GL_GOOGLE_include_directive : require
#define FIELD_IN_TEXELS
#define POINTS_IN_UNIFORM
#include "common/pose_bounds_narrow.glsl"
