// Jump flooding, one pass: an invocation looks from one cell of one or more rows at nine.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/jump_flood.glsl"
#include "common/launch.glsl"

layout(push_constant) uniform Params {
  uint width;
  uint height;
  uint stride;
  uint jump;
};
layout(set = 0, binding = 0, std430) readonly buffer Source { uint source[]; };
layout(set = 0, binding = 1, std430) writeonly buffer Target { uint target[]; };

// Offers the cell (x, y) the seeds of row `from_y` at -jump, 0 and +jump columns.
void offer_row(inout Flood best, uint x, uint y, uint from_y) {
  uint at = from_y * stride + x;
  if (x >= jump) {
    offer(best, source[at - jump], x, y);
  }
  offer(best, source[at], x, y);
  if (jump < width - x) {
    offer(best, source[at + jump], x, y);
  }
}

void main() {
  uint x = gl_GlobalInvocationID.x;
  if (x >= width) {
    return;
  }
  for (uint y = gl_GlobalInvocationID.y; y < height; y += launch_rows()) {
    Flood best = Flood(kNoSeed, kNoSeed);
    if (y >= jump) {
      offer_row(best, x, y, y - jump);
    }
    offer_row(best, x, y, y);
    if (jump < height - y) {
      offer_row(best, x, y, y + jump);
    }
    target[y * stride + x] = best.seed;
  }
}
