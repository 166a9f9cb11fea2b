// No result depends on what becomes of subnormal numbers, which a Vulkan device may take for 0 (docs/numerics.md): this
// processor, made to do so as well, gives the same bytes. Every case of the kernels that compute with floats.
#if defined(__x86_64__)  // the switch is this processor's

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <string>
#include <string_view>

#include "engine/compute/cases/kernel_cases.hpp"

namespace gdtslam::test {
namespace {

/// While it lives, subnormal numbers are 0 for this thread, as operands and as results.
class FlushToZero {
 public:
  FlushToZero() { _mm_setcsr(before_ | kFlushResults | kFlushOperands); }
  FlushToZero(const FlushToZero&) = delete;
  FlushToZero& operator=(const FlushToZero&) = delete;
  ~FlushToZero() { _mm_setcsr(before_); }

 private:
  static constexpr unsigned kFlushResults = 0x8000;
  static constexpr unsigned kFlushOperands = 0x0040;
  unsigned before_ = _mm_getcsr();
};

float doubled(float value) {
  const volatile float operand = value;
  return operand + operand;
}

TEST(FlushToZero, IsInForce) {
  EXPECT_GT(doubled(1.0e-40F), 0.0F);
  {
    const FlushToZero flush;
    EXPECT_EQ(doubled(1.0e-40F), 0.0F);
  }
  EXPECT_GT(doubled(1.0e-40F), 0.0F);
}

class Subnormals : public testing::TestWithParam<std::string_view> {};

TEST_P(Subnormals, MayBeTakenForZero) {
  std::size_t tried = 0;
  for (const Isa isa : {Isa::kBaseline, best_isa()}) {
    const auto cpu = make_cpu_backend({.threads = 1, .isa = isa});
    for (const KernelCaseSource& source : kernel_cases()) {
      if (source.kernel->name != GetParam() || source.large || source.benchmark) continue;
      const KernelCase made = source.make();
      const CaseOutcome expected = run_case(*cpu, made);
      CaseOutcome found;
      {
        const FlushToZero flush;
        found = run_case(*cpu, made);
      }
      const auto differs = difference(made, expected, found);
      EXPECT_FALSE(differs.has_value()) << to_string(isa) << " " << source.name << ": " << differs->values << " values";
      ++tried;
    }
  }
  EXPECT_GT(tried, 20U);
}

INSTANTIATE_TEST_SUITE_P(In, Subnormals,
                         testing::Values("pose_cost", "pose_descent", "sweep_points", "pose_bounds", "point_to_line",
                                         "ndt_cost"),
                         [](const auto& kernel) { return std::string(kernel.param); });

}  // namespace
}  // namespace gdtslam::test

#endif
