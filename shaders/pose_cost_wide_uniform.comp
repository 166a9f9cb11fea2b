// Cost of candidate poses, for large batches: the points in a uniform buffer, for every invocation reads the same one.
#version 450
#extension GL_GOOGLE_include_directive : require
#define POINTS uniform Points
#define MOST_ELEMENTS 1024
#include "common/pose_cost_single.glsl"
