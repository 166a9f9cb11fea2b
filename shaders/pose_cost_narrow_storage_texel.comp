// Cost of candidate poses for scans with more points than a uniform buffer takes on every device, the
// field in texels.
#version 450
#extension GL_GOOGLE_include_directive : require
#define FIELD_IN_TEXELS
#define POINTS readonly buffer Points
#define MOST_ELEMENTS
#include "common/pose_cost_four.glsl"
