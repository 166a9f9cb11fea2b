// Cost of candidate poses on a CPU as a device, for scans with more points than a uniform buffer takes.
#version 450
#extension GL_GOOGLE_include_directive : require
#define POINTS readonly buffer Points
#define MOST_ELEMENTS 
#include "common/pose_cost_four.glsl"
