#version 450
#extension GL_GOOGLE_include_directive : require
// The choice between poses, points in a storage buffer, the field in texels.

layout(set = 0, binding = 1, std430) readonly buffer Points { vec2 points[]; };

#define FIELD_IN_TEXELS
#define POINT(i) points[i]
#include "common/choose_pose.glsl"
