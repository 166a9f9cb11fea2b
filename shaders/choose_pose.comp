#version 450
#extension GL_GOOGLE_include_directive : require
// The choice between poses, points in a storage buffer.

layout(set = 0, binding = 1, std430) readonly buffer Points { vec2 points[]; };

#define POINT(i) points[i]
#include "common/choose_pose.glsl"
