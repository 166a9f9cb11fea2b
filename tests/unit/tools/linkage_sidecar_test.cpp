#include "engine/runs/folder/linkage_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace gdtslam {
namespace {

TEST(BesideLog, TakesTheEndingsOfALogOff) {
  EXPECT_EQ(sidecar_path("a/run.log", ".linkage.yaml"), "a/run.linkage.yaml");
  EXPECT_EQ(sidecar_path("a/run.log.gz", ".linkage.yaml"), "a/run.linkage.yaml");
  EXPECT_EQ(sidecar_path("run.clf.gz", ".truth.tum"), "run.truth.tum");
  EXPECT_EQ(sidecar_path("run.clf", ".truth.tum"), "run.truth.tum");
  EXPECT_EQ(sidecar_path("run.gz", ".truth.tum"), "run.truth.tum");
  EXPECT_EQ(sidecar_path("run.carmen", ".truth.tum"), "run.carmen.truth.tum");
  EXPECT_EQ(sidecar_path("run.log.log", ".truth.tum"), "run.log.truth.tum");
  EXPECT_EQ(sidecar_path(".log", ".x"), ".x");
  EXPECT_EQ(sidecar_path("", ".x"), ".x");
}

class LinkageBeside : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("linkage_beside_test_" + std::to_string(::getpid()));
};

TEST_F(LinkageBeside, IsWhereThereIsOne) {
  EXPECT_EQ(linkage_sidecar(path("run.log")), "");
  std::ofstream(path("run.linkage.yaml")) << "gdtslam_linkage: 1\n";
  EXPECT_EQ(linkage_sidecar(path("run.log")), path("run.linkage.yaml"));
  EXPECT_EQ(linkage_sidecar(path("run.clf.gz")), path("run.linkage.yaml"));
  EXPECT_EQ(linkage_sidecar(path("walk.log")), "");
}

TEST_F(LinkageBeside, StandardInputAndFoldersHaveNone) {
  std::filesystem::create_directories(path("run.linkage.yaml"));
  EXPECT_EQ(linkage_sidecar(path("run.log")), "");
  EXPECT_EQ(linkage_sidecar("-"), "");
}

}  // namespace
}  // namespace gdtslam
