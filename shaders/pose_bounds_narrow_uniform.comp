// Bounds of tiles of boxes on CPUs as devices, the points in a uniform buffer, from which they come faster.
#version 450
#extension GL_GOOGLE_include_directive : require
#define POINTS_IN_UNIFORM
#include "common/pose_bounds_narrow.glsl"
