// Cost of candidate poses on CPUs as devices, the points in a uniform buffer and the field in texels, from which they come
// faster.
#version 450
#extension GL_GOOGLE_include_directive : require
#define FIELD_IN_TEXELS
#define POINTS uniform Points
#define MOST_ELEMENTS 1024
#include "common/pose_cost_four.glsl"
