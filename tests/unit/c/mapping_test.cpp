// Mapping through the C interface gives the hashes that ship with the sample log, scan by scan and as a whole.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "c_support.hpp"
#include "engine/io/sha256.hpp"

namespace gdtslam::c {
namespace {

using ::testing::HasSubstr;

Owned<gdtslam_mapper> new_mapper(uint32_t flags, uint32_t threads = 0) {
  auto request = made<gdtslam_mapper_request>();
  request.flags = flags;
  request.threads = threads;
  gdtslam_mapper* mapper = nullptr;
  auto error = made<gdtslam_error>();
  EXPECT_EQ(gdtslam_mapper_new(&request, &mapper, &error), GDTSLAM_OK) << error.text;
  return Owned<gdtslam_mapper>(mapper);
}

void map_sample(gdtslam_mapper* mapper, const std::vector<KeptScan>& scans) {
  auto error = made<gdtslam_error>();
  for (const KeptScan& kept : scans) {
    const gdtslam_scan scan = kept.view();
    ASSERT_EQ(gdtslam_mapper_process(mapper, &scan, nullptr, &error), GDTSLAM_OK) << error.text;
  }
  ASSERT_EQ(gdtslam_mapper_close(mapper, nullptr, nullptr, &error), GDTSLAM_OK) << error.text;
}

Owned<gdtslam_grid> field_of_mapper(gdtslam_mapper* mapper) {
  gdtslam_grid* field = nullptr;
  auto error = made<gdtslam_error>();
  EXPECT_EQ(gdtslam_mapper_field(mapper, &field, &error), GDTSLAM_OK) << error.text;
  return Owned<gdtslam_grid>(field);
}

SampleHashes hashes_of(gdtslam_mapper* mapper) {
  const gdtslam_stamped_pose* poses = nullptr;
  std::size_t count = 0;
  EXPECT_EQ(gdtslam_mapper_trajectory(mapper, &poses, &count, nullptr), GDTSLAM_OK);
  Sha256 sum;
  for (std::size_t k = 0; k < count; ++k) sum.update(poses[k].x_m).update(poses[k].y_m).update(poses[k].theta_rad);
  return {gdtslam_grid_sha256(field_of_mapper(mapper).get()), sum.hex()};
}

TEST(CMapper, scan_by_scan_gives_the_hashes_of_the_whole_log) {
  const std::vector<KeptScan> scans = sample_scans();
  ASSERT_EQ(scans.size(), 350U);
  for (const bool with_loops : {false, true}) {
    const Owned<gdtslam_mapper> mapper = new_mapper(with_loops ? 0 : GDTSLAM_NO_LOOPS);
    map_sample(mapper.get(), scans);
    const SampleHashes found = hashes_of(mapper.get());
    EXPECT_EQ(found.map, sample_hashes(with_loops).map);
    EXPECT_EQ(found.trajectory, sample_hashes(with_loops).trajectory);
  }
}

TEST(CMapper, of_several_threads_do_not_know_of_each_other) {
  const std::vector<KeptScan> scans = sample_scans();
  std::vector<SampleHashes> found(4);
  std::vector<std::thread> threads;
  for (SampleHashes& hashes : found) {
    threads.emplace_back([&] {
      const Owned<gdtslam_mapper> mapper = new_mapper(GDTSLAM_NO_LOOPS, 2);
      map_sample(mapper.get(), scans);
      hashes = hashes_of(mapper.get());
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const SampleHashes& hashes : found) EXPECT_EQ(hashes.map, sample_hashes(false).map);
}

TEST(CMapper, is_closed_once) {
  const Owned<gdtslam_mapper> mapper = new_mapper(0);
  auto error = made<gdtslam_error>();
  EXPECT_EQ(gdtslam_mapper_close(mapper.get(), nullptr, nullptr, &error), GDTSLAM_BAD_INPUT) << "nothing was mapped";
  const std::vector<KeptScan> scans = sample_scans();
  map_sample(mapper.get(), {scans.begin(), scans.begin() + 20});
  EXPECT_EQ(gdtslam_mapper_close(mapper.get(), nullptr, nullptr, &error), GDTSLAM_USAGE);
  const gdtslam_scan scan = scans[20].view();
  EXPECT_EQ(gdtslam_mapper_process(mapper.get(), &scan, nullptr, &error), GDTSLAM_USAGE);
  EXPECT_THAT(error.text, HasSubstr("is closed"));
}

// The field of one wall, by hand: cells of the wall hold little, cells far from it the cap.
TEST(CMapper, gives_its_field_while_it_maps_and_a_field_outlives_the_mapper) {
  for (const uint32_t flags : {0U, uint32_t{GDTSLAM_NO_LOOPS}}) {
    Owned<gdtslam_mapper> mapper = new_mapper(flags);
    constexpr double kStep_rad = 0.01;
    constexpr int kHalf = 60;
    std::vector<float> ranges;
    for (int k = -kHalf; k <= kHalf; ++k) ranges.push_back(static_cast<float>(3.0 / std::cos(k * kStep_rad)));
    auto scan = made<gdtslam_scan>();
    scan.first_bearing_rad = -kHalf * kStep_rad;
    scan.bearing_step_rad = kStep_rad;
    scan.ranges_m = ranges.data();
    scan.range_count = ranges.size();
    auto match = made<gdtslam_match>();
    ASSERT_EQ(gdtslam_mapper_process(mapper.get(), &scan, &match, nullptr), GDTSLAM_OK);
    EXPECT_TRUE(match.is_accepted != 0 && match.is_keyframe != 0);
    const Owned<gdtslam_grid> grid = field_of_mapper(mapper.get());
    mapper.reset();
    auto view = made<gdtslam_grid_view>();
    ASSERT_EQ(gdtslam_grid_look(grid.get(), &view, nullptr), GDTSLAM_OK);
    const auto value_at = [&view](double x_m, double y_m) {
      const auto x = static_cast<std::size_t>(std::floor((x_m - view.origin_x_m) / view.resolution_m));
      const auto y = static_cast<std::size_t>(std::floor((y_m - view.origin_y_m) / view.resolution_m));
      const auto* const bytes = static_cast<const unsigned char*>(view.cells) + y * view.row_bytes;
      return reinterpret_cast<const std::uint16_t*>(bytes)[x];
    };
    EXPECT_EQ(view.cell_bytes, 2U);
    EXPECT_EQ(view.row_bytes, 2U * static_cast<std::size_t>(view.width));
    EXPECT_EQ(view.cap, 20U * 256U) << "0.5 m of cells of 2.5 cm";
    EXPECT_LE(value_at(3.0125, 0.0), 256U);
    EXPECT_NEAR(value_at(2.8125, 0.0), 8 * 256, 256);
    EXPECT_EQ(value_at(2.3, 0.0), view.cap);
  }
}

class CWholeLog : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    whole_folder = new TempDir;
    auto error = made<gdtslam_error>();
    ASSERT_EQ(gdtslam_map_log(kSampleLog.c_str(), place().c_str(), &whole_run, &error), GDTSLAM_OK) << error.text;
  }
  static void TearDownTestSuite() {
    gdtslam_run_free(whole_run);
    delete whole_folder;
  }
  static std::string place() { return (whole_folder->path() / "run").string(); }
  static gdtslam_run* whole_run;
  static TempDir* whole_folder;
};
gdtslam_run* CWholeLog::whole_run = nullptr;
TempDir* CWholeLog::whole_folder = nullptr;

TEST_F(CWholeLog, has_the_hashes_that_ship_with_it) {
  EXPECT_EQ(gdtslam_run_map_sha256(whole_run), sample_hashes(true).map);
  EXPECT_EQ(gdtslam_run_trajectory_sha256(whole_run), sample_hashes(true).trajectory);
  EXPECT_EQ(gdtslam_run_folder(whole_run), place());
  EXPECT_THAT(gdtslam_run_report(whole_run), HasSubstr("\"map_sha256\": \"" + sample_hashes(true).map));
}

TEST_F(CWholeLog, gives_poses_in_full_and_those_of_the_file_when_it_is_opened) {
  const gdtslam_stamped_pose* poses = nullptr;
  std::size_t count = 0;
  ASSERT_EQ(gdtslam_run_trajectory(whole_run, &poses, &count, nullptr), GDTSLAM_OK);
  Sha256 sum;
  for (std::size_t k = 0; k < count; ++k) sum.update(poses[k].x_m).update(poses[k].y_m).update(poses[k].theta_rad);
  EXPECT_EQ(sum.hex(), sample_hashes(true).trajectory);
  gdtslam_run* opened = nullptr;
  ASSERT_EQ(gdtslam_run_open(place().c_str(), &opened, nullptr), GDTSLAM_OK);
  const Owned<gdtslam_run> again(opened);
  const gdtslam_stamped_pose* read = nullptr;
  std::size_t read_count = 0;
  ASSERT_EQ(gdtslam_run_trajectory(opened, &read, &read_count, nullptr), GDTSLAM_OK);
  ASSERT_EQ(read_count, count);
  for (std::size_t k = 0; k < count; ++k) EXPECT_NEAR(read[k].x_m, poses[k].x_m, 1e-9);
}

TEST_F(CWholeLog, is_drawn_by_the_names_of_views) {
  for (const char* view : {"map", "graph", "field", "distance"}) {
    auto request = made<gdtslam_picture_request>();
    request.view = view;
    request.format = "svg";
    gdtslam_bytes* picture = nullptr;
    auto error = made<gdtslam_error>();
    ASSERT_EQ(gdtslam_run_render(whole_run, &request, &picture, &error), GDTSLAM_OK) << error.text;
    const Owned<gdtslam_bytes> owned(picture);
    const std::string text(static_cast<const char*>(gdtslam_bytes_data(picture)), gdtslam_bytes_count(picture));
    EXPECT_TRUE(text.starts_with("<svg ")) << view;
    EXPECT_THAT(text, HasSubstr("office-start"));
  }
  auto request = made<gdtslam_picture_request>();
  gdtslam_bytes* picture = nullptr;
  request.view = "iso";
  EXPECT_EQ(gdtslam_run_render(whole_run, &request, &picture, nullptr), GDTSLAM_USAGE);
  request.view = "map";
  request.format = "gif";
  EXPECT_EQ(gdtslam_run_render(whole_run, &request, &picture, nullptr), GDTSLAM_USAGE);
  request.format = "svg";
  request.width = 100;
  EXPECT_EQ(gdtslam_run_render(whole_run, &request, &picture, nullptr), GDTSLAM_USAGE) << "no height";
  EXPECT_EQ(picture, nullptr);
}

TEST_F(CWholeLog, is_where_scans_are_found_by_several_threads_at_once) {
  auto request = made<gdtslam_localizer_request>();
  const std::string map = place();
  request.map = map.c_str();
  gdtslam_localizer* opened = nullptr;
  auto error = made<gdtslam_error>();
  ASSERT_EQ(gdtslam_localizer_new(&request, &opened, &error), GDTSLAM_OK) << error.text;
  const Owned<gdtslam_localizer> localizer(opened);
  const std::vector<KeptScan> scans = sample_scans();
  const gdtslam_stamped_pose* poses = nullptr;
  std::size_t count = 0;
  ASSERT_EQ(gdtslam_run_trajectory(whole_run, &poses, &count, nullptr), GDTSLAM_OK);
  std::vector<gdtslam_location> found(2, made<gdtslam_location>());
  const std::vector<std::size_t> chosen{100, 200};
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    threads.emplace_back([&, k] {
      const gdtslam_scan scan = scans[chosen[k]].view();
      EXPECT_EQ(gdtslam_localizer_find(localizer.get(), &scan, &found[k], nullptr), GDTSLAM_OK);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    EXPECT_EQ(found[k].verdict, GDTSLAM_FOUND);
    EXPECT_NEAR(found[k].T_map_base.x_m, poses[chosen[k]].x_m, 0.03);
    EXPECT_NEAR(found[k].T_map_base.y_m, poses[chosen[k]].y_m, 0.03);
    EXPECT_LE(found[k].proven_gap_m, 0.005);
  }
  auto empty = made<gdtslam_scan>();
  auto none = made<gdtslam_location>();
  EXPECT_EQ(gdtslam_localizer_find(localizer.get(), &empty, &none, &error), GDTSLAM_OK) << error.text;
  EXPECT_EQ(none.verdict, GDTSLAM_NO_POSE);
}

TEST_F(CWholeLog, is_where_a_robot_is_followed_and_a_tracker_outlives_its_localizer) {
  auto request = made<gdtslam_localizer_request>();
  const std::string map = place();
  request.map = map.c_str();
  gdtslam_localizer* localizer = nullptr;
  gdtslam_tracker* opened = nullptr;
  ASSERT_EQ(gdtslam_localizer_new(&request, &localizer, nullptr), GDTSLAM_OK);
  ASSERT_EQ(gdtslam_tracker_new(localizer, &opened, nullptr), GDTSLAM_OK);
  gdtslam_localizer_free(localizer);
  const Owned<gdtslam_tracker> tracker(opened);
  const gdtslam_stamped_pose* poses = nullptr;
  std::size_t count = 0;
  ASSERT_EQ(gdtslam_run_trajectory(whole_run, &poses, &count, nullptr), GDTSLAM_OK);
  const std::vector<KeptScan> scans = sample_scans();
  auto tracked = made<gdtslam_tracked>();
  for (std::size_t k = 0; k < 150; ++k) {
    const gdtslam_scan scan = scans[k].view();
    ASSERT_EQ(gdtslam_tracker_follow(tracker.get(), &scan, &tracked, nullptr), GDTSLAM_OK);
  }
  EXPECT_EQ(tracked.whereabouts, GDTSLAM_TRACKED);
  EXPECT_NEAR(tracked.T_map_base.x_m, poses[149].x_m, 0.03);
  EXPECT_GT(tracked.covariance[0], 0.0);
}

}  // namespace
}  // namespace gdtslam::c
