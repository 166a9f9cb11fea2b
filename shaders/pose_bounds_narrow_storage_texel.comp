// Bounds of tiles of boxes for scans with more points than a uniform buffer takes on every device, the field in texels.
#version 450
#extension GL_GOOGLE_include_directive : require
#define FIELD_IN_TEXELS
#include "common/pose_bounds_narrow.glsl"
