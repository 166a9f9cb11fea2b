// What becomes of the points on their way into cloud.ply, counted by hand.
#include "engine/runs/drive/cloud_output.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr int kSide = 60;

// Floor at 0 and ceiling at 2.5 m, 3 x 3 m, 5 cm apart, as floats so that voxels of 5 cm are halved nowhere; and a
// post.
struct Room {
  Cloud floor;
  Cloud ceiling;
  Cloud post;
};

Room room() {
  Room room;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const auto x = static_cast<float>(0.05 * i + 0.025);
      const auto y = static_cast<float>(0.05 * j + 0.025);
      room.floor.push_back({x, y, 0.0F, 0.1F, 1.0, 1});
      room.ceiling.push_back({x, y, 2.5F, 0.9F, 2.0, 2});
    }
  }
  for (int k = 0; k < 40; ++k) room.post.push_back({1.0F, 1.0F, static_cast<float>(0.225 + 0.05 * k), 0.4F, 3.0, 3});
  return room;
}

class CloudOutputFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  CloudSummary write(const CloudConfig& config) {
    CloudOutput output(config, path());
    const Room points = room();
    output.add(points.floor);
    output.add({});
    output.add(points.post);
    output.add(points.ceiling);
    output.add(points.floor);  // seen again
    return output.finish();
  }
  [[nodiscard]] std::string path() const { return (folder_ / "cloud.ply").string(); }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename());
    return names;
  }
  fs::path folder_ = fs::path(testing::TempDir()) / ("cloud_output_test_" + std::to_string(::getpid()));
};

constexpr std::uint64_t kPlane = kSide * kSide;
constexpr std::uint64_t kPost = 40;
constexpr std::uint64_t kMeasured = 3 * kPlane + kPost;

TEST_F(CloudOutputFile, KeepsEveryPointInOrderWithoutThinning) {
  const CloudSummary summary = write({.voxel_m = 0.0});
  EXPECT_EQ(summary.measured, kMeasured);
  EXPECT_EQ(summary.thinned, kMeasured);
  EXPECT_EQ(summary.removed, 0U);
  EXPECT_EQ(summary.written, kMeasured);
  const Cloud cloud = read_cloud(path());
  ASSERT_EQ(cloud.size(), kMeasured);
  EXPECT_EQ(cloud.front(), room().floor.front());
  EXPECT_EQ(cloud[kPlane + 3], room().post[3]);
  EXPECT_EQ(cloud.back(), room().floor.back());
  EXPECT_EQ(files(), std::vector<std::string>{"cloud.ply"});
}

TEST_F(CloudOutputFile, ThinsToOnePointAVoxel) {
  const CloudSummary summary = write({.voxel_m = 0.05});
  EXPECT_EQ(summary.measured, kMeasured);
  EXPECT_EQ(summary.thinned, 2 * kPlane + kPost);
  EXPECT_EQ(summary.written, summary.thinned);
  EXPECT_EQ(read_cloud(path()).size(), summary.written);
}

TEST_F(CloudOutputFile, TakesFloorAndCeilingOutAndSaysWhereTheyWere) {
  const CloudSummary summary = write({.voxel_m = 0.0, .remove = CloudRemoval::kBoth});
  ASSERT_TRUE(summary.surfaces.floor && summary.surfaces.ceiling);
  EXPECT_NEAR(summary.surfaces.floor->centre.z(), 0.0, 1e-3);
  EXPECT_NEAR(summary.surfaces.ceiling->centre.z(), 2.5, 1e-3);
  EXPECT_EQ(summary.thinned, kMeasured);
  EXPECT_EQ(summary.removed, 3 * kPlane);
  EXPECT_EQ(summary.written, kPost);
  EXPECT_EQ(read_cloud(path()), room().post);
  EXPECT_EQ(files(), std::vector<std::string>{"cloud.ply"});  // no spool
}

TEST_F(CloudOutputFile, TakesOnlyWhatItIsAskedFor) {
  const CloudSummary floor = write({.voxel_m = 0.0, .remove = CloudRemoval::kFloor});
  EXPECT_EQ(floor.removed, 2 * kPlane);
  EXPECT_FALSE(floor.surfaces.ceiling.has_value());
  const CloudSummary ceiling = write({.voxel_m = 0.0, .remove = CloudRemoval::kCeiling});
  EXPECT_EQ(ceiling.removed, kPlane);
  EXPECT_FALSE(ceiling.surfaces.floor.has_value());
  // The post's lowest point, 22.5 cm up, is within a margin of 25 cm; its second, 27.5 cm up, is not.
  const CloudSummary wide = write({.voxel_m = 0.0, .remove = CloudRemoval::kFloor, .remove_margin_m = 0.25});
  EXPECT_EQ(wide.removed, 2 * kPlane + 1);
}

}  // namespace
}  // namespace gdtslam
