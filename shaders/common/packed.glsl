// Cells of 8 and 16 bits, packed into words: shaders neither need nor ask for small storage types. The first cell is in
// the lowest bits.
#ifndef GDTSLAM_PACKED_GLSL
#define GDTSLAM_PACKED_GLSL

uvec4 unpack_bytes(uint word) { return uvec4(word, word >> 8, word >> 16, word >> 24) & 0xFFu; }
uint pack_bytes(uvec4 cells) { return cells.x | cells.y << 8 | cells.z << 16 | cells.w << 24; }

uvec2 unpack_pair(uint word) { return uvec2(word & 0xFFFFu, word >> 16); }
uint pack_pair(uvec2 cells) { return cells.x | cells.y << 16; }

uvec4 unpack_cells(uvec2 words) { return uvec4(unpack_pair(words.x), unpack_pair(words.y)); }
uvec2 pack_cells(uvec4 cells) { return uvec2(pack_pair(cells.xy), pack_pair(cells.zw)); }

#endif
