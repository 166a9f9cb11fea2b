// Position of a scan's point on a field and the field's value there, to the bit like
// engine/compute/kernels/pose_cost/pose_cost.hpp.
//
// Declares the field, binding 0 of the kernel: words of two cells of a row, the left one in the low half.
// Offers: FieldView and field_view() (what does not change from point to point), CellRotation and cell_rotation(),
// point_position() (1/256 cell from the field's corner), nearest_value() and bilinear_value() there, cost_term(),
// saturating_add(). Costing and point_cost() are all of it, for shaders whose interpolation is a constant.
#ifndef GDTSLAM_FIELD_LOOKUP_GLSL
#define GDTSLAM_FIELD_LOOKUP_GLSL

#include "common/elementary.glsl"
#include "common/field_layout.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Field { uint field[]; };

const uint kBilinear = 0u;  // Interpolation
const uint kNearest = 1u;
const uint kDistance = 0u;  // CostForm
const uint kSquared = 1u;

struct FieldView {
  ivec2 anchor;  // 1/256 cell
  ivec2 last;    // largest cell that may be read with its right and upper neighbour
  uint stride;
  uint strip;  // from strip to strip, kStripWidth for rows
  uint blank;  // twice, one for each of two neighbours
};

FieldView field_view(uint width, uint height, uint stride, uint strip, uint blank, int anchor_x, int anchor_y) {
  return FieldView(ivec2(anchor_x, anchor_y) * 256, ivec2(uvec2(width, height)) - 2, stride, strip,
                   blank << 16 | blank);
}

struct CellRotation {
  float s;
  float c;
};

CellRotation cell_rotation(float theta) {
  SinCosF32 both = sin_cos_f32(theta);
  return CellRotation(both.sin_value, both.cos_value);
}

/// Cells to whole 1/256 cells; NaN counts as far off the map.
int quantised(float cells) {
  precise float scaled = cells * 256.0 + 0.5;
  scaled = floor(scaled);
  scaled = scaled > -1073741824.0 ? scaled : -1073741824.0;
  scaled = scaled < 1073741824.0 ? scaled : 1073741824.0;
  return int(scaled);
}

/// A point of the scan at a pose: position from the field's corner.
ivec2 point_position(FieldView view, CellRotation r, vec2 translation, vec2 point) {
  precise float u = (r.c * point.x - r.s * point.y) + translation.x;
  precise float v = (r.s * point.x + r.c * point.y) + translation.y;
  return ivec2(quantised(u), quantised(v)) + view.anchor;
}

uint cell_index(FieldView view, ivec2 position) {
  ivec2 cell = clamp(position >> 8, ivec2(0), view.last);
  return field_place(uint(cell.x), uint(cell.y), view.stride, view.strip);
}

/// The cell that holds the position.
uint nearest_value(FieldView view, ivec2 position) {
  uint cell = cell_index(view, position);
  return ((field[cell >> 1] ^ view.blank) >> ((cell & 1u) << 4)) & 0xFFFFu;
}

/// Two neighbours in a row, the left one in the low half. Rows begin at whole words, so the word behind is read only
/// where the right neighbour lies in it.
uint cell_pair(uint cell) {
  uint odd = cell & 1u;
  uint first = field[cell >> 1];
  uint second = field[(cell >> 1) + odd];
  return odd == 0u ? first : (first >> 16) | (second << 16);
}

/// Between the four cells whose centres surround the position.
uint bilinear_value(FieldView view, ivec2 position) {
  ivec2 centred = position - 128;
  uvec2 fraction = uvec2(centred & 255);
  uint cell = cell_index(view, centred);
  uint lower_pair = cell_pair(cell) ^ view.blank;
  uint upper_pair = cell_pair(cell + view.stride) ^ view.blank;
  // a (256 - f) + b f = 256 a + (b - a) f: the differences wrap around, the sums below 2^32 are right again.
  uint lower_left = lower_pair & 0xFFFFu;
  uint upper_left = upper_pair & 0xFFFFu;
  uint lower = (lower_left << 8) + ((lower_pair >> 16) - lower_left) * fraction.x;
  uint upper = (upper_left << 8) + ((upper_pair >> 16) - upper_left) * fraction.x;
  return ((lower << 8) + (upper - lower) * fraction.y) >> 16;
}

/// Brings squares of values up to the cap into 16 bits.
uint squared_shift(uint cap) {
  int bits = 2 * (findMSB(cap) + 1);
  return bits > 16 ? uint(bits - 16) : 0u;
}

/// Contribution of a value to a cost.
uint cost_term(uint value, uint cap, uint form, uint square_shift) {
  uint capped = min(value, cap);
  return form == kSquared ? (capped * capped) >> square_shift : capped;
}

/// a + b, at most 2^32 - 1.
uint saturating_add(uint a, uint b) {
  uint sum = a + b;
  return sum < a ? 0xFFFFFFFFu : sum;
}

/// A pose whose points are costed: what does not change from point to point.
struct Costing {
  FieldView view;
  CellRotation rotation;
  vec2 translation;
  uint cap;
  uint form;
  uint square_shift;
};

uint point_cost(Costing costing, uint interpolation, vec2 point) {
  ivec2 position = point_position(costing.view, costing.rotation, costing.translation, point);
  uint value = interpolation == kBilinear ? bilinear_value(costing.view, position)
                                          : nearest_value(costing.view, position);
  return cost_term(value, costing.cap, costing.form, costing.square_shift);
}

#endif
