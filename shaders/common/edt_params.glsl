// Parameters of the four passes of the exact distance transform (EdtColumns::Params), and the value that stands for "no
// seed" in the unlimited ones.
#ifndef GDTSLAM_EDT_PARAMS_GLSL
#define GDTSLAM_EDT_PARAMS_GLSL

layout(push_constant) uniform Params {
  uint width;
  uint height;
  uint stride;
  uint radius;
};

const uint kNoSeed = 0xFFFFFFFFu;

#endif
