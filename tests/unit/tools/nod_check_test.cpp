// What doctor says of a mount's messages.
#include "engine/runs/streams/log_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gdtslam {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// 100 Hz, 200 ticks a message, a counter that starts again every 1000.
NodChecker turning(int messages) {
  NodChecker checker;
  for (int k = 0; k < messages; ++k) checker.add(Encoder{0.01 * k, (200 * k) % 1000});
  return checker;
}

TEST(NodCheck, ACounterThatStartsAgainIsNoReversal) {
  const NodCheck check = turning(101).finish();
  EXPECT_EQ(check.encoder_records, 101U);
  EXPECT_EQ(check.falls, 20U);
  EXPECT_EQ(check.reversals, 0U);
  EXPECT_EQ(check.lowest_ticks, 0);
  EXPECT_EQ(check.highest_ticks, 800);
  EXPECT_NEAR(check.mean_rate_hz, 100.0, 1e-9);
  EXPECT_NEAR(check.longest_gap_s, 0.01, 1e-9);
  EXPECT_THAT(check.suggestions(), Contains(HasSubstr("--linkage")));
  EXPECT_THAT(check.suggestions(), Not(Contains(HasSubstr("direction"))));
}

TEST(NodCheck, GapsStopsAndReversalsShow) {
  NodChecker checker = turning(5);
  checker.add(Encoder{1.04, 800});
  checker.add(Encoder{1.05, 700});
  checker.add(Encoder{1.02, 650});
  const NodCheck check = checker.finish();
  EXPECT_NEAR(check.longest_gap_s, 1.0, 1e-9);
  EXPECT_NEAR(check.longest_gap_at_s, 0.04, 1e-9);
  EXPECT_EQ(check.still_steps, 1U);
  EXPECT_EQ(check.reversals, 1U);
  EXPECT_EQ(check.backward_stamps, 1U);
  EXPECT_THAT(check.suggestions(), Contains(HasSubstr("no message of the mount for 1.000 s after 0.040000 s")));
  EXPECT_THAT(check.suggestions(), Contains(HasSubstr("direction 1 times")));
  EXPECT_THAT(check.suggestions(), Contains(HasSubstr("go backward")));
}

TEST(NodCheck, ADeadEncoderShows) {
  NodChecker checker;
  for (int k = 0; k < 10; ++k) checker.add(Encoder{0.01 * k, 77});
  EXPECT_THAT(checker.finish().suggestions(), Contains(HasSubstr("never turns")));
}

TEST(NodCheck, ATiltingLaserNeedsNoLinkage) {
  NodChecker checker;
  for (int k = 0; k < 11; ++k) checker.add(Tilt{0.1 * k, -0.5 + 0.1 * k});
  const NodCheck check = checker.finish();
  EXPECT_NEAR(check.lowest_tilt_rad, -0.5, 1e-12);
  EXPECT_NEAR(check.highest_tilt_rad, 0.5, 1e-12);
  EXPECT_NEAR(check.mean_rate_hz, 10.0, 1e-9);
  EXPECT_THAT(check.suggestions(), Contains(HasSubstr("the laser tilts")));
}

TEST(NodCheck, NothingIsSaidOfALaserThatIsFixed) { EXPECT_TRUE(NodChecker{}.finish().suggestions().empty()); }

}  // namespace
}  // namespace gdtslam
