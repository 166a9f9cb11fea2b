// What is said of a map, from reports that somebody may have made.
#include "engine/runs/folder/run_review.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

Trajectory ten_poses() {
  Trajectory trajectory;
  for (std::size_t i = 0; i < 10; ++i) {
    trajectory.push_back({100.0 + static_cast<double>(i), {static_cast<double>(i), -0.5, 0.0}});
  }
  return trajectory;
}

ClosedLoop loop_of(std::size_t from, std::size_t to, double weight) {
  ClosedLoop loop;
  loop.from = from;
  loop.to = to;
  loop.weight = weight;
  loop.is_on = weight > 0.25;
  return loop;
}

RunDoubts sound() {
  RunDoubts doubts{.scans = 10, .accepted = 10, .loops = LoopFindings{}};
  doubts.loops->searches = 4;
  doubts.loops->loops = {loop_of(0, 9, 0.9)};
  return doubts;
}

TEST(RunReview, OfASoundMapHasNothingToSay) { EXPECT_TRUE(review_notes(sound(), ten_poses(), {}).empty()); }

TEST(RunReview, AFaultOfTheLogComesFirstUnlessItIsMended) {
  RunDoubts doubts = sound();
  doubts.refused = 3;
  doubts.findings = {{"mirrored", "16 turns", "--set log.bearing_step=-2deg", false}, {"7.99 m", "90 %", "", true}};
  const std::vector<ReviewNote> notes = review_notes(doubts, ten_poses(), {});
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_EQ(notes[0].about, "log");
  EXPECT_EQ(notes[0].finding, "mirrored (16 turns)");
  EXPECT_EQ(notes[0].advice, "map the log again with --set log.bearing_step=-2deg");
  EXPECT_EQ(notes[1].about, "scans");
}

TEST(RunReview, AStretchIsWhereItsLeastSurePoseIs) {
  RunDoubts doubts = sound();
  doubts.loops->uncertain = {{0, 2, 0.2}, {4, 6, 0.5}, {8, 9, 0.3}};
  std::vector<PoseCovariance> covariances(10, PoseCovariance{.xx = 0.04, .yy = 0.04});
  covariances[6].yy = 0.25;
  const std::vector<ReviewNote> notes = review_notes(doubts, ten_poses(), covariances);
  ASSERT_EQ(notes.size(), 3U);
  EXPECT_THAT(notes[0].advice, HasSubstr("come back to where the drive began"));
  EXPECT_EQ(notes[1].finding,
            "scans 4 to 6 (104.0 s to 106.0 s), worst at (6.0, -0.5) m: standard deviation up to 0.5 m");
  EXPECT_THAT(notes[1].advice, HasSubstr("drive there again"));
  EXPECT_THAT(notes[2].advice, HasSubstr("end the drive at a place"));
  EXPECT_EQ(notes[2].at_m, Point2(8.0, -0.5));
  // Without covariances: the middle.
  EXPECT_EQ(review_notes(doubts, ten_poses(), {}).at(1).at_m, Point2(5.0, -0.5));
}

}  // namespace
}  // namespace gdtslam
