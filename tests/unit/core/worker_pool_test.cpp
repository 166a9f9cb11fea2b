#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "engine/core/worker_pool.hpp"

namespace gdtslam::test {
namespace {

TEST(WorkerPool, GivesEachIndexOnce) {
  for (const unsigned threads : {1U, 2U, 5U}) {
    WorkerPool workers(threads);
    ASSERT_EQ(workers.threads(), threads);
    for (const std::uint64_t count : {0U, 1U, 2U, 63U, 64U, 1009U}) {
      std::vector<int> times(count, 0);
      workers.run(count, 1, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t i = begin; i < end; ++i) ++times[i];
      });
      EXPECT_EQ(times, std::vector<int>(count, 1)) << threads << " threads";
    }
  }
}

TEST(WorkerPool, SlicesBeginAtMultiplesOfTheGrain) {
  WorkerPool workers(3);
  std::mutex mutex;
  std::set<std::uint64_t> begins;
  workers.run(1000, 64, [&](std::uint64_t begin, std::uint64_t end) {
    const std::lock_guard lock(mutex);
    begins.insert(begin);
    EXPECT_TRUE(end % 64 == 0 || end == 1000);
  });
  for (const std::uint64_t begin : begins) EXPECT_EQ(begin % 64, 0U);
  EXPECT_GT(begins.size(), 1U);
}

TEST(WorkerPool, WithOneThreadTheCallerDoesItAll) {
  WorkerPool alone(1);
  std::set<std::thread::id> by;
  alone.run(100, 1, [&](std::uint64_t, std::uint64_t) { by.insert(std::this_thread::get_id()); });
  EXPECT_EQ(by, std::set{std::this_thread::get_id()});
}

TEST(WorkerPool, WhatASliceThrowsReachesTheCallerAndTheNextRangeIsDone) {
  WorkerPool workers(4);
  for (int round = 0; round < 20; ++round) {
    EXPECT_THROW(workers.run(1000, 1,
                             [](std::uint64_t begin, std::uint64_t) {
                               if (begin > 0) throw std::runtime_error("a slice failed");
                             }),
                 std::runtime_error);
    std::atomic<std::uint64_t> sum{0};
    workers.run(1000, 1, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) sum += i;
    });
    EXPECT_EQ(sum.load(), 499500U);
  }
}

TEST(WorkerPool, ZeroMeansOneThreadAProcessor) {
  EXPECT_GE(threads_meant(0), 1U);
  EXPECT_EQ(threads_meant(3), 3U);
}

}  // namespace
}  // namespace gdtslam::test
