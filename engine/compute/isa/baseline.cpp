// The kernels for the baseline of the target; flags in CMakeLists.txt.
#define GDTSLAM_ISA_LEVEL 0
#define GDTSLAM_ISA_FUNCTIONS kBaselineFunctions
#include "kernels.inl"
