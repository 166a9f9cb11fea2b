// Bounds of tiles of boxes for scans with more points than a uniform buffer takes on every device.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/pose_bounds_narrow.glsl"
