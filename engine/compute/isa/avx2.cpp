// The kernels for AVX2; flags in CMakeLists.txt.
#define GDTSLAM_ISA_LEVEL 1
#define GDTSLAM_ISA_FUNCTIONS kAvx2Functions
#include "kernels.inl"
