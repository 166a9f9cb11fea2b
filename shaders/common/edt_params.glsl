// Parameters of a pass of a truncated distance transform (EdtColumns::Params, JumpFloodDistance::Params).
#ifndef GDTSLAM_EDT_PARAMS_GLSL
#define GDTSLAM_EDT_PARAMS_GLSL

layout(push_constant) uniform Params {
  uint width;
  uint height;
  uint stride;
  uint radius;
};

#endif
