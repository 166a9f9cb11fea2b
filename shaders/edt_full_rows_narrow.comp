// Unlimited distance transform, rows, by the lower envelope of parabolas [Meijster2000]: its time does not depend on
// the distances. An invocation does a row. The envelope's stack lives in the row's part of the output, which has one
// word a column: an entry is its apex and the column distance there, 15 bits each; entry j rules from a column >= j on,
// so filling the row from its end overwrites no entry that is still needed.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/edt_params.glsl"
#include "common/launch.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Distance { uvec4 column_distance[]; };
layout(set = 0, binding = 1, std430) buffer SqDistance { uvec4 sq_distance[]; };

// A parabola: its apex and its height there; where it begins to rule.
struct Site {
  int apex;
  int sq;
  int from;
};

uint stack_entry(uint index) { return sq_distance[index / 4][index % 4]; }

Site unpacked_site(uint word) {
  int distance = int(word >> 16);
  return Site(int(word & 0xFFFFu), distance * distance, 0);
}

int value_at(Site site, int x) {
  int dx = x - site.apex;
  return dx * dx + site.sq;
}

// First column, at least 0 and at most the width, at which the parabola of `right` is strictly below that of `left`.
// The float quotient is off by less than one where it matters; integers correct it, so its rounding does not.
int first_below(Site left, Site right) {
  int twice = right.apex * right.apex + right.sq - left.apex * left.apex - left.sq;
  int span = 2 * (right.apex - left.apex);
  int quotient = int(clamp(float(twice) / float(span), -1.0, float(width)));
  int rest = twice - quotient * span;
  quotient += rest < 0 ? -1 : 0;
  quotient += rest >= span ? 1 : 0;
  return clamp(quotient + 1, 0, int(width));
}

// The stack, its two uppermost entries in registers.
struct Envelope {
  uint row;
  int count;
  Site top;
  Site second;
};

// Takes the uppermost parabola away.
void pop(inout Envelope envelope) {
  --envelope.count;
  envelope.top = envelope.second;
  envelope.second = unpacked_site(stack_entry(envelope.row + uint(max(envelope.count - 2, 0))));
}

void push(inout Envelope envelope, Site site, uint distance) {
  uint entry = envelope.row + uint(envelope.count);
  sq_distance[entry / 4][entry % 4] = uint(site.apex) | distance << 16;
  ++envelope.count;
  envelope.second = envelope.top;
  envelope.top = site;
}

// The envelope at a column, after that of the next column on the right: the parabola below the uppermost begins to rule
// where it is not above it, and they do so one at a time.
int value_from_right(inout Envelope envelope, int x) {
  int value = value_at(envelope.top, x);
  int next = value_at(envelope.second, x);
  if (envelope.count > 1 && next <= value) {
    pop(envelope);
    value = next;
  }
  return value;
}

void main() {
  uint y = gl_GlobalInvocationID.x;
  if (y >= height) {
    return;
  }
  Envelope envelope = Envelope(y * stride, 0, Site(0, 0, 0), Site(0, 0, 0));
  // Each turn of the loop either takes a parabola away or goes on to the next column.
  for (int x = 0; x < int(width);) {
    uint cell = envelope.row + uint(x);
    uint distance = column_distance[cell / 4][cell % 4];
    Site site = Site(x, int(distance * distance), 0);
    bool is_seed = distance != kNoSeed;
    int from = envelope.top.from;
    bool is_hidden = is_seed && envelope.count > 0 && value_at(site, from) <= value_at(envelope.top, from);
    if (is_hidden) {
      pop(envelope);
    }
    Site left = is_hidden ? envelope.second : envelope.top;
    Site right = is_hidden ? envelope.top : site;
    right.from = envelope.count > (is_hidden ? 1 : 0) ? first_below(left, right) : 0;
    if (is_hidden) {
      envelope.top.from = right.from;
    } else {
      if (is_seed && right.from < int(width)) {
        push(envelope, right, distance);
      }
      ++x;
    }
  }
  bool none = envelope.count == 0;
  for (int x = int(width + 3) / 4 * 4 - 4; x >= 0; x -= 4) {
    uvec4 quad;
    quad.w = uint(value_from_right(envelope, x + 3));
    quad.z = uint(value_from_right(envelope, x + 2));
    quad.y = uint(value_from_right(envelope, x + 1));
    quad.x = uint(value_from_right(envelope, x));
    sq_distance[(envelope.row + uint(x)) / 4] = none ? uvec4(kNoSeed) : quad;
  }
}
