// The kernels for AVX-512 (F, BW, DQ, VL, CD); flags in CMakeLists.txt.
#define GDTSLAM_ISA_LEVEL 2
#define GDTSLAM_ISA_FUNCTIONS kAvx512Functions
#if defined(__GNUC__) && !defined(__clang__)
// gcc 12 reports the undefined pass-through operands of its own intrinsics as uninitialised variables (gcc bug 105593).
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#endif
#include "kernels.inl"
