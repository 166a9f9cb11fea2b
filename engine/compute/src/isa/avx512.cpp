// The kernels for AVX-512 (F, BW, DQ, VL, CD); flags in CMakeLists.txt.
#define GDTSLAM_ISA_LEVEL 2
#define GDTSLAM_ISA_FUNCTIONS kAvx512Functions
#include "isa/kernels.inl"
