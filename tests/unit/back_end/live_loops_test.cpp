// Loops looked for by a thread beside the mapping: what is seen of it depends on the keyframes alone.
#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include "engine/mapping/loops/live_loops.hpp"
#include "gdtslam/core/error.hpp"
#include "loop_drive.hpp"

namespace gdtslam {
namespace {

using test::LoopDrive;

Keyframe keyframe_at(const LoopDrive& drive, std::size_t i) {
  return {drive.path.scans[i], drive.path.poses[i], drive.path.path_m[i], drive.path.steps[i], drive.path.travels[i]};
}

/// The correction after each keyframe.
std::vector<Pose2> corrections_of(LiveLoops& loops, const LoopDrive& drive) {
  std::vector<Pose2> corrections;
  for (std::size_t i = 0; i < drive.path.poses.size(); ++i) {
    loops.take(keyframe_at(drive, i));
    corrections.push_back(loops.correction());
  }
  return corrections;
}

/// Of the last keyframe, with a correction.
double last_error_m(const LoopDrive& drive, const Pose2& T_closed_front) {
  return ((T_closed_front * drive.path.poses.back()).translation() - drive.truth.back().translation()).norm();
}

class LiveLoopsSeeds : public testing::TestWithParam<std::uint64_t> {};

// One closer that has the whole path, a thread, and no thread.
TEST_P(LiveLoopsSeeds, GiveWhatThePathTakenWholeGives) {
  const LoopDrive twice = test::drive_around_ring(2, 0.01, 0.003, GetParam());
  LoopCloser whole(twice.path, {});
  WorkerPool alone(1);
  whole.run([](double, int) {}, alone);
  std::vector<std::vector<Pose2>> corrections;
  for (const bool is_beside : {true, false}) {
    LiveLoops loops({}, {.is_beside = is_beside, .threads = 3});
    corrections.push_back(corrections_of(loops, twice));
    LoopCloser& closer = loops.end([](double) {});
    closer.run([](double, int) {}, alone);
    EXPECT_EQ(closer.poses(), whole.poses());
    EXPECT_EQ(closer.places(), whole.places());
    ASSERT_EQ(closer.graph().loops.size(), whole.graph().loops.size());
    for (std::size_t i = 0; i < whole.graph().loops.size(); ++i) {
      EXPECT_EQ(closer.graph().loops[i].relation.T_from_to, whole.graph().loops[i].relation.T_from_to);
      EXPECT_EQ(closer.graph().loops[i].weight, whole.graph().loops[i].weight);
    }
    EXPECT_GT(loops.statistics().corrections, 0U);
    EXPECT_EQ(loops.statistics().places, whole.places().size());
    EXPECT_EQ(loops.statistics().waited_s > 0.0, loops.statistics().waits > 0);
    EXPECT_GE(loops.statistics().waited_s, 0.0);
  }
  EXPECT_EQ(corrections.front(), corrections.back());
}

TEST_P(LiveLoopsSeeds, TheCorrectionComesLateAndBringsTheRobotBack) {
  const LoopDrive twice = test::drive_around_ring(2, 0.01, 0.003, GetParam());
  LiveLoops loops({}, {});
  const std::vector<Pose2> corrections = corrections_of(loops, twice);
  // No place of the first round but the last 5 m can be seen again before this.
  const double earliest_m = test::kRingRound_m - 6.0 + 4.0 * static_cast<double>(LiveLoops::kPlacesLate);
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    if (twice.path.path_m[i] >= earliest_m) break;
    EXPECT_EQ(corrections[i], Pose2{}) << i;
  }
  EXPECT_LT(last_error_m(twice, corrections.back()), std::max(0.2, 0.5 * last_error_m(twice, {})));
}
INSTANTIATE_TEST_SUITE_P(Seeds, LiveLoopsSeeds, testing::Values(1, 2, 3));

/// A distance field this fine has more cells to an obstacle than the kernels count.
LoopOptions too_fine() {
  LoopOptions options;
  options.search.resolution_m = 1.0e-3;
  return options;
}

TEST(LiveLoops, WhatTheThreadMeetsComesToTheCallerAtTheSameKeyframe) {
  const LoopDrive twice = test::drive_around_ring(2, 0.01, 0.003, 1);
  std::vector<std::size_t> thrown_at;
  for (const bool is_beside : {true, false}) {
    LiveLoops loops(too_fine(), {.is_beside = is_beside});
    std::vector<std::size_t> thrown;
    for (std::size_t i = 0; i < twice.path.poses.size(); ++i) {
      try {
        loops.take(keyframe_at(twice, i));
      } catch (const std::exception&) {
        thrown.push_back(i);
      }
    }
    ASSERT_GT(thrown.size(), 1U) << "at each later place again";
    thrown_at.push_back(thrown.front());
    EXPECT_ANY_THROW(loops.end([](double) {}));
    loops.abandon();
    EXPECT_EQ(loops.path().poses, twice.path.poses) << "no keyframe is lost";
  }
  EXPECT_EQ(thrown_at.front(), thrown_at.back());
}

TEST(LiveLoops, AbandonedAtAnyTimeTheyHaveAllKeyframes) {
  const LoopDrive twice = test::drive_around_ring(2, 0.01, 0.003, 2);
  for (const std::size_t keyframes : {std::size_t{0}, std::size_t{1}, std::size_t{60}, twice.path.poses.size()}) {
    LiveLoops loops({}, {});
    for (std::size_t i = 0; i < keyframes; ++i) loops.take(keyframe_at(twice, i));
    loops.abandon();
    ASSERT_EQ(loops.path().poses.size(), keyframes);
    for (std::size_t i = 0; i < keyframes; ++i) {
      EXPECT_EQ(loops.path().poses[i], twice.path.poses[i]);
      EXPECT_EQ(loops.path().path_m[i], twice.path.path_m[i]);
      EXPECT_EQ(loops.path().scans[i].points(), twice.path.scans[i].points());
    }
  }
}

// Steps wait on a shelf from the next place on, which may be in a file.
TEST(LiveLoops, AtTheEndEachStepIsThere) {
  const LoopDrive twice = test::drive_around_ring(2, 0.01, 0.003, 1);
  for (const bool is_beside : {true, false}) {
    LiveLoops loops({}, {.is_beside = is_beside, .scratch_folder = testing::TempDir(), .shelf_bytes = 4096});
    for (std::size_t i = 0; i < twice.path.poses.size(); ++i) loops.take(keyframe_at(twice, i));
    const LoopCloser& closer = loops.end([](double) {});
    EXPECT_EQ(closer.carried_keyframes().size(), twice.path.poses.size());
    const FrontEndPath& found = loops.path();
    EXPECT_EQ(found.first_step, 0U);
    ASSERT_EQ(found.steps.size(), twice.path.steps.size());
    ASSERT_EQ(found.travels.size(), twice.path.travels.size());
    for (std::size_t i = 0; i < found.steps.size(); ++i) {
      for (std::size_t source = 0; source < kStepSources; ++source) {
        EXPECT_EQ(found.steps[i][source].T, twice.path.steps[i][source].T) << i;
        EXPECT_EQ(found.steps[i][source].information.m, twice.path.steps[i][source].information.m) << i;
        EXPECT_EQ(found.steps[i][source].cautious.m, twice.path.steps[i][source].cautious.m) << i;
      }
      EXPECT_EQ(found.travels[i].path_m, twice.path.travels[i].path_m) << i;
      EXPECT_EQ(found.travels[i].turned_rad, twice.path.travels[i].turned_rad) << i;
      EXPECT_EQ(found.travels[i].is_measured, twice.path.travels[i].is_measured) << i;
    }
  }
}

// What progress() throws while the thread is at work goes through, as an interrupt does.
TEST(LiveLoops, AnInterruptWhileTheyEndIsPassedOn) {
  const LoopDrive twice = test::drive_around_ring(2, 0.01, 0.003, 3);
  struct Interrupt {};
  LiveLoops loops({}, {});
  for (std::size_t i = 0; i < twice.path.poses.size(); ++i) loops.take(keyframe_at(twice, i));
  bool is_interrupted = false;
  try {
    for (int k = 0; k < 2000; ++k) loops.request_map({});  // work for longer than it takes to ask
    loops.end([](double share) {
      EXPECT_GT(share, 0.0);
      EXPECT_LE(share, 1.0);
      throw Interrupt{};
    });
  } catch (const Interrupt&) {
    is_interrupted = true;
  }
  EXPECT_TRUE(is_interrupted);
  loops.abandon();
  EXPECT_EQ(loops.path().poses.size(), twice.path.poses.size());
}

/// Threads of this process that block SIGINT.
std::size_t threads_that_block_interrupts() {
  std::size_t count = 0;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream status(task.path() / "status");
    std::string word;
    while (status >> word) {
      if (word != "SigBlk:") continue;
      status >> word;
      if ((std::stoull(word, nullptr, 16) >> (SIGINT - 1) & 1U) != 0) ++count;
    }
  }
  return count;
}

TEST(LiveLoops, SignalsGoToTheProgramsOwnThreads) {
  std::thread([] {}).join();  // with the first one ThreadSanitizer begins one of its own, which blocks all signals
  const LoopDrive once = test::drive_around_ring(1, 0.01, 0.003, 1);
  const std::size_t before = threads_that_block_interrupts();
  LiveLoops loops({}, {});
  loops.take(keyframe_at(once, 0));
  EXPECT_EQ(threads_that_block_interrupts(), before + 1);
  loops.abandon();
  EXPECT_EQ(threads_that_block_interrupts(), before) << "the caller's mask is as it was";
}

// Threads with a stack that no machine has cannot be started.
TEST(LiveLoops, WithoutAThreadTheCallerDoesItWithOneWarning) {
  const LoopDrive twice = test::drive_around_ring(2, 0.01, 0.003, 1);
  LiveLoops alone({}, {.is_beside = false});
  pthread_attr_t usual;
  pthread_attr_t huge;
  ASSERT_EQ(pthread_getattr_default_np(&usual), 0);
  ASSERT_EQ(pthread_attr_init(&huge), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&huge, std::size_t{1} << 46U), 0);
  ASSERT_EQ(pthread_setattr_default_np(&huge), 0);
  std::vector<std::string> warnings;
  LiveLoops refused({}, {.is_beside = true, .warn = [&](const std::string& text) { warnings.push_back(text); }});
  refused.take(keyframe_at(twice, 0));
  ASSERT_EQ(pthread_setattr_default_np(&usual), 0);
  alone.take(keyframe_at(twice, 0));
  for (std::size_t i = 1; i < twice.path.poses.size(); ++i) {
    refused.take(keyframe_at(twice, i));
    alone.take(keyframe_at(twice, i));
    ASSERT_EQ(refused.correction(), alone.correction());
  }
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings.front().find("no thread"), std::string::npos);
  EXPECT_EQ(refused.end([](double) {}).graph().poses, alone.end([](double) {}).graph().poses);
}

/// Distance to the nearest obstacle at the points of a scan, cells; the mean.
double mean_distance_cells(const GlobalField& field, const KeptScan& scan, const Pose2& T_map_base) {
  double sum = 0.0;
  const std::vector<Point2> points = to_points(scan);
  for (const Point2& point : points) {
    sum += field.at(map_cell_at(T_map_base * point, field.geometry().resolution_m)) / 256.0;
  }
  return sum / static_cast<double>(points.size());
}

TEST(LiveLoops, AFrozenMapIsThatOfTheKeyframesWhenItWasAskedFor) {
  const LoopDrive twice = test::drive_around_ring(2, 0.01, 0.003, 1);
  const std::size_t asked_at = twice.path.poses.size() - 20;
  std::vector<FrozenMap> maps;
  for (const bool is_beside : {true, false}) {
    LiveLoops loops({}, {.is_beside = is_beside});
    std::shared_future<FrozenMap> map;
    for (std::size_t i = 0; i < twice.path.poses.size(); ++i) {
      loops.take(keyframe_at(twice, i));
      if (i + 1 == asked_at) map = loops.request_map({});
    }
    maps.push_back(map.get());
  }
  for (const FrozenMap& map : maps) {  // the loops are gone
    EXPECT_EQ(map.keyframes, asked_at);
    EXPECT_EQ(map.T_closed_front, maps.front().T_closed_front);
    EXPECT_EQ(map.field->download(), maps.front().field->download());
    const std::size_t late = asked_at - 60;
    const Pose2 closed = map.T_closed_front * twice.path.poses[late];
    EXPECT_LT(mean_distance_cells(*map.field, twice.path.scans[late], closed), 3.0);
    EXPECT_LT(mean_distance_cells(*map.field, twice.path.scans[5], twice.path.poses[5]), 3.0);
  }
}

TEST(LiveLoops, MapsThatCannotBeMadeSaySo) {
  const LoopDrive once = test::drive_around_ring(1, 0.01, 0.003, 1);
  std::shared_future<FrozenMap> too_large;
  std::shared_future<FrozenMap> too_late;
  {
    LiveLoops loops({}, {});
    for (std::size_t i = 0; i < once.path.poses.size(); ++i) loops.take(keyframe_at(once, i));
    MapperConfig config;
    config.map.max_megacells = 1;
    config.map.resolution_m = 0.01;
    too_large = loops.request_map(config);
    too_large.wait();
    for (int k = 0; k < 2000; ++k) too_late = loops.request_map({});
  }
  EXPECT_THROW(too_large.get(), InputError);
  EXPECT_THROW(too_late.get(), std::future_error);
}

}  // namespace
}  // namespace gdtslam
