// A keyframe merged into the map, paper equations (1) and (9) to (11). An invocation does four cells, two words, of a
// row of a tile: the nearest of the tile's obstacles, its value from the disc, the merge. Cells of these words beside
// the tile's width are written back as they were. No other invocation writes them, as rows begin at a multiple of four
// cells.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/launch.glsl"
#include "common/packed.glsl"

layout(push_constant) uniform Params {
  uint tile_count;
  uint words;
  uint most_obstacles;
  uint stride;
  uint radius;
  uint threshold;
  uint lift;
  uint cap;
  uint rule;
  uint strip;
  uint blank;
};
layout(set = 0, binding = 0, std430) buffer Field { uvec2 field[]; };
layout(set = 0, binding = 1, std430) readonly buffer List { uvec4 list[]; };  // the tiles, then four obstacles each
layout(set = 0, binding = 2, std430) readonly buffer Disc { uint disc[]; };
#include "common/field_layout.glsl"
#include "common/merge_rule.glsl"

const uint kQuadsARow = 16;  // quads in a row of a tile of 64 x 64 cells
const uint kQuads = 1024;
const uint kDiscMargin = 32;
const uint kNone = 0xFFFFFFFFu;

// The keys of the obstacles for one cell: squared distance, |dy| and |dx| from the highest bits down; kNone beyond R.
uvec4 keys(uvec4 at, int x, int y) {
  uvec4 dx = uvec4(abs(ivec4(at & 0xFFFFu) - x));
  uvec4 dy = uvec4(abs(ivec4(at >> 16) - y));
  uvec4 squared = dx * dx + dy * dy;
  uvec4 key = squared << 16 | dy << 8 | dx;
  return mix(key, uvec4(kNone), greaterThan(squared, uvec4(radius * radius)));
}

uint least(uvec4 a) { return min(min(a.x, a.y), min(a.z, a.w)); }

// The disc's value for a key; what is beyond every scan's field where there is none.
uint value_of(uint key) {
  bool is_none = key == kNone;
  uint row = is_none ? 0 : key >> 8 & 0xFFu;
  uint column = (is_none ? 0 : key & 0xFFu) + radius + kDiscMargin;
  uint cell = row * ((2 * radius + 1 + 2 * kDiscMargin + 3) / 4 * 4) + column;
  uint value = disc[cell / 2] >> (cell & 1) * 16 & 0xFFFFu;
  return is_none ? 0xFFFFu : value;
}

void main() {
  uint item = linear_invocation();
  if (item / kQuads >= tile_count) {
    return;
  }
  uvec4 tile = list[item / kQuads];
  uint column = item % kQuadsARow * 4;
  uint row = item % kQuads / kQuadsARow;
  uint width = tile.y & 0xFFFFu;
  if (column >= width || row >= tile.y >> 16) {
    return;
  }
  int x = int(column + radius);
  int y = int(row + radius);
  uvec4 nearest = uvec4(kNone);
  uint end = (tile.z + tile.w + 3) / 4;
  for (uint group = tile.z / 4; group < end; ++group) {
    uvec4 at = list[group];
    nearest = min(nearest, uvec4(least(keys(at, x, y)), least(keys(at, x + 1, y)), least(keys(at, x + 2, y)),
                                 least(keys(at, x + 3, y))));
  }
  uvec4 stamped = uvec4(value_of(nearest.x), value_of(nearest.y), value_of(nearest.z), value_of(nearest.w));
  stamped = mix(uvec4(0xFFFFu), stamped, lessThan(uvec4(column) + uvec4(0, 1, 2, 3), uvec4(width)));
  uint word = (tile.x + row * stride + column) / 4;
  uvec4 cells = merged(unpack_cells(field[word]) ^ blank, stamped) ^ blank;
  field[word] = pack_cells(cells);
  // The first cell of a strip's row is the 65th of the strip before, in words that nobody else writes.
  if (strip != kStripWidth && column == 0 && tile.x >= strip) {
    uint before = word - (strip - kStripWidth) / 4;
    field[before].x = (field[before].x & 0xFFFF0000u) | cells.x;
  }
}
