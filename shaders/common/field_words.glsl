// The field of a kernel, its binding 0, as field_lookup.glsl reads it: FIELD_WORD(i) is 32-bit word i. Words of a storage
// buffer or, where the includer defines FIELD_IN_TEXELS, of a uniform texel buffer: lavapipe gathers from that at once, and
// from a storage buffer lane by lane.
#ifndef GDTSLAM_FIELD_WORDS_GLSL
#define GDTSLAM_FIELD_WORDS_GLSL

#ifdef FIELD_IN_TEXELS
layout(set = 0, binding = 0) uniform usamplerBuffer field;
#define FIELD_WORD(i) texelFetch(field, int(i)).x
#else
layout(set = 0, binding = 0, std430) readonly buffer Field { uint field[]; };
#define FIELD_WORD(i) field[i]
#endif

#endif
