// 1 / value for a value from 1e-30 to 1e30, within some units in the last place: a device's own division may differ.
#ifndef GDTSLAM_RECIPROCAL_GLSL
#define GDTSLAM_RECIPROCAL_GLSL

float reciprocal(float value) {
  precise float r = uintBitsToFloat(0x7EF311C7u - floatBitsToUint(value));
  r = r * (2.0 - value * r);
  r = r * (2.0 - value * r);
  r = r * (2.0 - value * r);
  return r;
}

#endif
