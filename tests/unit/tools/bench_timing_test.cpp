// How the benchmark sums up its samples.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>

#include "tools/lab/bench/rows.hpp"

namespace gdtslam {
namespace {

// The upper one of the two in the middle, so that a row of two samples does not tell its faster one.
TEST(BenchTiming, TheMedianOfTwoSamplesIsTheSlowerOne) {
  constexpr std::array<double, 3> kDevice_ns{7e9, 1e9, 3e9};  // of the trial, then of both samples
  std::size_t done = 0;
  const Work work{.step = [] {}, .device_ns = [&] { return kDevice_ns.at(done++); }};
  const Timing timing = measure(work, {.samples = 2, .sample_s = 0.0});
  EXPECT_EQ(timing.samples, 2);
  ASSERT_TRUE(timing.device_s.has_value());
  EXPECT_DOUBLE_EQ(*timing.device_s, 3.0);
}

}  // namespace
}  // namespace gdtslam
