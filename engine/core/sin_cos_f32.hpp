// shaders/common/elementary.glsl as C++: the few names of GLSL that it uses. Thread-safe, constant time.
#pragma once

#include <bit>
#include <cstdint>

namespace gdtslam::shader {

inline std::int32_t floatBitsToInt(float value) { return std::bit_cast<std::int32_t>(value); }
inline float intBitsToFloat(std::int32_t bits) { return std::bit_cast<float>(bits); }

// The build turns contraction off, which is what `precise` asks of a shader compiler.
#define precise
#include "elementary.glsl"
#undef precise

}  // namespace gdtslam::shader
