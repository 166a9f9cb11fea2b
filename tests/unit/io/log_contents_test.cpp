// What is counted in passing stays bounded, and its quantiles are those of all that was seen.
#include "engine/io/log_contents.hpp"

#include <gtest/gtest.h>

#include <string>

#include "engine/io/recordings/recording_survey.hpp"

namespace gdtslam {
namespace {

TEST(EvenSample, HasTheQuantilesOfAll) {
  for (const int count : {1, 2, 511, 512, 513, 1025, 100000}) {
    EvenSample sample;
    for (int k = 0; k < count; ++k) sample.add(static_cast<double>(k));
    EXPECT_EQ(sample.seen(), static_cast<std::uint64_t>(count));
    for (const double share : {0.0, 0.05, 0.5, 0.95, 1.0}) {
      EXPECT_NEAR(sample.quantile(share), share * (count - 1), 0.005 * count + 0.5) << count << " " << share;
    }
  }
  EXPECT_EQ(EvenSample().quantile(0.5), 0.0);
}

TEST(LineCounter, KeepsTheFirstKindsApart) {
  LineCounter counter;
  for (int k = 0; k < 1000; ++k) counter.add("KIND" + std::to_string(k), true);
  counter.add("KIND7", true);
  ASSERT_EQ(counter.list().size(), 65U);
  EXPECT_EQ(counter.list()[7].count, 2U);
  EXPECT_EQ(counter.list().back().name, "other kinds");
  EXPECT_EQ(counter.list().back().count, 936U);
}

}  // namespace
}  // namespace gdtslam
