#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/side_thread.hpp"

namespace gdtslam::test {
namespace {

TEST(SideThread, CarriesTasksOutInTheirOrder) {
  for (const bool has_thread : {false, true}) {
    for (const std::size_t most_waiting : {1U, 2U, 64U}) {
      SideThread side(has_thread, most_waiting);
      std::vector<int> done;
      std::vector<int> given;
      for (int k = 0; k < 500; ++k) {
        given.push_back(k);
        side.give([&done, k] { done.push_back(k); });
      }
      side.finish();
      EXPECT_EQ(done, given) << has_thread << ' ' << most_waiting;
    }
  }
}

TEST(SideThread, GoesOnBesideTheCallerOnlyWhereItHasAThread) {
  for (const bool has_thread : {false, true}) {
    SideThread side(has_thread, 4);
    std::atomic<bool> is_elsewhere{false};
    side.give(
        [&is_elsewhere, here = std::this_thread::get_id()] { is_elsewhere = std::this_thread::get_id() != here; });
    side.finish();
    EXPECT_EQ(is_elsewhere.load(), has_thread);
    EXPECT_EQ(side.cpu_s() > 0.0, has_thread);
  }
}

TEST(SideThread, NoMoreWaitThanMay) {
  SideThread side(true, 8);
  std::atomic<int> given{0};
  std::atomic<int> begun{0};
  std::atomic<int> most{0};
  for (int k = 0; k < 200; ++k) {
    side.give([&] {
      most = std::max(most.load(), given.load() - begun.load());
      ++begun;
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    });
    ++given;
  }
  side.finish();
  EXPECT_EQ(begun.load(), 200);
  EXPECT_LE(most.load(), 10);  // those that wait, the one at work and the one being given
}

TEST(SideThread, WhatATaskThrowsReachesTheCallerAndNothingAfterItIsDone) {
  for (const bool has_thread : {false, true}) {
    SideThread side(has_thread, 2);
    std::atomic<int> done{0};
    const auto give_all = [&] {
      for (int k = 0; k < 100; ++k) {
        side.give([&done, k] {
          if (k == 10) throw std::runtime_error("a task failed");
          ++done;
        });
      }
      side.finish();
    };
    EXPECT_THROW(give_all(), std::runtime_error);
    EXPECT_THROW(side.finish(), std::runtime_error);
    EXPECT_EQ(done.load(), 10);
  }
}

TEST(SideThread, DropsWhatIsNotBegunWhenItGoes) {
  std::atomic<int> done{0};
  {
    SideThread side(true, 1000);
    for (int k = 0; k < 100; ++k) side.give([&done] { ++done; });
  }
  EXPECT_LE(done.load(), 100);
}

}  // namespace
}  // namespace gdtslam::test
