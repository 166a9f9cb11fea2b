// How the rows of the benchmark go through what they measure.
#include <gtest/gtest.h>

#include <cstddef>
#include <set>

#include "tools/lab/bench/rows.hpp"

namespace gdtslam {
namespace {

TEST(BenchOrder, ComesByEachOnce) {
  for (std::size_t count = 1; count < 200; ++count) {
    const std::size_t stride = spreading_stride(count);
    std::set<std::size_t> met;
    for (std::size_t k = 0; k < count; ++k) met.insert(k * stride % count);
    EXPECT_EQ(met.size(), count) << count;
  }
}

}  // namespace
}  // namespace gdtslam
