// Common head of all shaders: work group sizes are specialisation constants 0, 1 and 2, so that one shader serves
// devices that like different ones, and the position of an invocation in its launch.
#ifndef GDTSLAM_LAUNCH_GLSL
#define GDTSLAM_LAUNCH_GLSL

layout(local_size_x_id = 0, local_size_y_id = 1, local_size_z_id = 2) in;

// Group of a one-dimensional launch that was folded into rows of 65535 groups; may be beyond the last one.
uint linear_group() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

// Invocation of such a launch; may be beyond the last one.
uint linear_invocation() { return linear_group() * gl_WorkGroupSize.x + gl_LocalInvocationID.x; }

// Rows of a grid launch from one row of an invocation to its next: a launch may have fewer rows than the grid, either
// to give each invocation more work or because the grid has more than 65535.
uint launch_rows() { return gl_NumWorkGroups.y * gl_WorkGroupSize.y; }

#endif
