// One run that several threads read at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <latch>
#include <string>
#include <thread>
#include <vector>

#include "c_support.hpp"

namespace gdtslam::c {
namespace {

class CSharedRun : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const log = kSampleLog.c_str();
    auto request = made<gdtslam_map_request>();
    request.logs = &log;
    request.log_count = 1;
    request.folder = folder_.c_str();
    request.flags = GDTSLAM_NO_LOOPS | GDTSLAM_NO_PICTURES;
    request.scan_count = 40;
    ASSERT_EQ(gdtslam_map_logs(&request, nullptr, &error_), GDTSLAM_OK) << error_.text;
  }
  void open() {
    gdtslam_run* opened = nullptr;
    ASSERT_EQ(gdtslam_run_open(folder_.c_str(), &opened, &error_), GDTSLAM_OK) << error_.text;
    run_.reset(opened);
  }
  // Each in its own thread, all at once.
  static void do_all(const std::vector<std::function<void()>>& works) {
    std::latch start(static_cast<std::ptrdiff_t>(works.size()));
    std::vector<std::thread> threads;
    for (const auto& work : works) {
      threads.emplace_back([&start, &work] {
        start.arrive_and_wait();
        work();
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
  [[nodiscard]] Owned<gdtslam_grid> grid_by(decltype(gdtslam_run_map)* read) const {
    gdtslam_grid* grid = nullptr;
    EXPECT_EQ(read(run_.get(), &grid, nullptr), GDTSLAM_OK);
    return Owned<gdtslam_grid>(grid);
  }
  void draw(const char* view) const {
    auto request = made<gdtslam_picture_request>();
    request.view = view;
    request.format = "svg";
    gdtslam_bytes* picture = nullptr;
    EXPECT_EQ(gdtslam_run_render(run_.get(), &request, &picture, nullptr), GDTSLAM_OK) << view;
    gdtslam_bytes_free(picture);
  }

  TempDir temp_;
  std::string folder_ = (temp_.path() / "run").string();
  gdtslam_error error_ = made<gdtslam_error>();
  Owned<gdtslam_run> run_;
};

// Each file is checked when it is asked for the first time, by whoever comes first.
TEST_F(CSharedRun, is_read_and_drawn_at_once) {
  const auto read_map = [&] { EXPECT_NE(grid_by(gdtslam_run_map), nullptr); };
  const auto read_field = [&] {
    EXPECT_STREQ(gdtslam_grid_sha256(grid_by(gdtslam_run_field).get()), gdtslam_run_map_sha256(run_.get()));
  };
  for (int times = 0; times < 5; ++times) {
    open();
    do_all({read_map, read_field, [&] { draw("map"); }, [&] { draw("distance"); }, read_map, read_field});
  }
}

TEST_F(CSharedRun, gives_all_the_same_poses) {
  for (int times = 0; times < 20; ++times) {
    open();
    std::vector<const gdtslam_stamped_pose*> given(8);
    std::vector<std::function<void()>> works;
    for (const gdtslam_stamped_pose*& poses : given) {
      works.emplace_back([&] {
        std::size_t count = 0;
        EXPECT_EQ(gdtslam_run_trajectory(run_.get(), &poses, &count, nullptr), GDTSLAM_OK);
        EXPECT_EQ(count, 40U);
      });
    }
    do_all(works);
    ASSERT_THAT(given, ::testing::Each(given.front()));
  }
}

}  // namespace
}  // namespace gdtslam::c
