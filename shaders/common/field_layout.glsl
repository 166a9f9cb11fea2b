// Layout of a field's cells (engine/compute/include/gdtslam/compute/kernel.hpp).
#ifndef GDTSLAM_FIELD_LAYOUT_GLSL
#define GDTSLAM_FIELD_LAYOUT_GLSL

const uint kStripWidth = 64u;

uint field_place(uint x, uint y, uint stride, uint strip) {
  return x / kStripWidth * strip + x % kStripWidth + y * stride;
}

#endif
