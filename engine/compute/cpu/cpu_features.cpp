#include "gdtslam/compute/backend.hpp"
#include "launch.hpp"

namespace gdtslam {

bool isa_available(Isa isa) {
  if (!is_compiled(isa)) {
    return false;
  }
#ifdef GDTSLAM_X86_KERNELS
  if (isa == Isa::kAvx2) {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma");
  }
  if (isa == Isa::kAvx512) {
    return isa_available(Isa::kAvx2) && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512cd");
  }
#endif
  return true;
}

Isa best_isa() {
  static const Isa best = [] {
    if (isa_available(Isa::kAvx512)) {
      return Isa::kAvx512;
    }
    return isa_available(Isa::kAvx2) ? Isa::kAvx2 : Isa::kBaseline;
  }();
  return best;
}

}  // namespace gdtslam
