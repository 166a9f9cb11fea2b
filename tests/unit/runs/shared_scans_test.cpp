// Which scans two runs have both, by hand: the stamp and each range have to be the same.
#include "engine/runs/sites/run_session.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <tuple>
#include <utility>
#include <vector>

namespace gdtslam {
namespace {

using Pair = std::tuple<std::size_t, std::size_t, std::size_t>;

RunKeyframe keyframe(double stamp_s, std::vector<float> ranges_m) {
  RunKeyframe made;
  made.laser.stamp_s = stamp_s;
  made.laser.ranges_m = std::move(ranges_m);
  return made;
}

std::vector<Pair> shared_of(const std::vector<std::vector<RunKeyframe>>& runs) {
  std::vector<RunKeyframes> kept(runs.size());
  std::vector<const RunKeyframes*> named;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    kept[k].keyframes = runs[k];
    named.push_back(&kept[k]);
  }
  std::vector<Pair> pairs;
  for (const SharedScans& pair : shared_scans(named)) pairs.emplace_back(pair.first, pair.second, pair.keyframes);
  return pairs;
}

constexpr float kNone = std::numeric_limits<float>::infinity();

TEST(SharedScans, HaveOneStampAndOneSetOfRanges) {
  const std::vector<RunKeyframe> first{keyframe(1.0, {2.0F, kNone}), keyframe(2.0, {2.0F, 3.0F}),
                                       keyframe(3.0, {4.0F, 3.0F})};
  EXPECT_EQ(shared_of({first, {keyframe(2.0, {2.0F, 3.0F}), keyframe(1.0, {2.0F, kNone})}}),
            (std::vector<Pair>{{0, 1, 2}}));
  EXPECT_EQ(shared_of({first, {keyframe(1.5, {2.0F, kNone})}}), std::vector<Pair>{}) << "another stamp";
  EXPECT_EQ(shared_of({first, {keyframe(1.0, {2.0F, 3.0F})}}), std::vector<Pair>{}) << "another range";
  EXPECT_EQ(shared_of({first, {keyframe(1.0, {2.0F})}}), std::vector<Pair>{}) << "a beam less";
  EXPECT_EQ(shared_of({first, {}}), std::vector<Pair>{});
}

// As a site has the keyframes of a run that is in it, or an edited run those of its source.
TEST(SharedScans, MayHaveLostReadings) {
  const std::vector<RunKeyframe> run{keyframe(1.0, {2.0F, 3.0F, 4.0F})};
  EXPECT_EQ(shared_of({run, {keyframe(1.0, {2.0F, kNone, 4.0F})}}), (std::vector<Pair>{{0, 1, 1}}));
  EXPECT_EQ(
      shared_of({{keyframe(1.0, {kNone, 3.0F, 4.0F, 5.0F, 6.0F})}, {keyframe(1.0, {2.0F, 3.0F, 4.0F, 5.0F, kNone})}}),
      (std::vector<Pair>{{0, 1, 1}}))
      << "each another one";
  EXPECT_EQ(shared_of({run, {keyframe(1.0, {2.0F, kNone, 4.001F})}}), std::vector<Pair>{}) << "another reading";
  EXPECT_EQ(shared_of({run, {keyframe(1.0, {kNone, kNone, kNone})}}), std::vector<Pair>{}) << "nothing counts twice";
  EXPECT_EQ(shared_of({{keyframe(1.0, {kNone, 3.0F})}, {keyframe(1.0, {2.0F, kNone})}}), std::vector<Pair>{})
      << "nothing is in both";
  EXPECT_EQ(shared_of({run, {keyframe(1.0, {kNone, 3.0F, kNone})}}), std::vector<Pair>{}) << "more is out than left";
}

TEST(SharedScans, OfEachTwoOfThreeRuns) {
  const RunKeyframe a = keyframe(1.0, {1.0F});
  const RunKeyframe b = keyframe(2.0, {1.0F});
  EXPECT_EQ(shared_of({{a, b}, {b}, {b, a}}), (std::vector<Pair>{{0, 1, 1}, {0, 2, 2}, {1, 2, 1}}));
}

TEST(SharedScans, OneThatALogRepeatsIsOne) {
  const RunKeyframe a = keyframe(1.0, {1.0F});
  EXPECT_EQ(shared_of({{a, a}, {}}), std::vector<Pair>{}) << "within one run";
  EXPECT_EQ(shared_of({{a, a}, {a, a, a}}), (std::vector<Pair>{{0, 1, 1}}));
}

}  // namespace
}  // namespace gdtslam
