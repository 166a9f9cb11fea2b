// Errors of a file as a whole begin with its name alone; a number behind it would be a line that is not to blame.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "engine/io/file_limits.hpp"
#include "engine/io/meshes/mesh_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

// Files that people give in place of a log: each is called by its name, with what to do.
TEST(WholeFileErrors, OfFilesThatAreNoLogs) {
  const auto said = [](const std::string& bytes) {
    const TemporaryFolder folder;
    put_file(folder / "f", bytes);
    return told_by<InputError>([&] { drain(*open_log(folder / "f", {})); }, "no error").substr((folder / "f").size());
  };
  const std::string give = "; give a CARMEN, CSV, JSON lines, ROS bag or MCAP log";
  EXPECT_EQ(said(""), ": is empty" + give);
  EXPECT_EQ(said("lorem ipsum\n"), ": holds no complete CARMEN message in 1 lines" + give);
  EXPECT_EQ(said("\x89PNG\r\n\x1a\n"), ": is a PNG picture, not a log" + give);
  EXPECT_EQ(said("# .PCD v0.7 - Point Cloud Data\nVERSION 0.7\n"), ": is a PCD point cloud, not a log" + give);
  EXPECT_EQ(said("ply\nformat ascii 1.0\n"), ": is a PLY file, not a log" + give);
  for (const char* head : {"", "# a comment\n", "\xef\xbb\xbf"}) {
    EXPECT_EQ(said(std::string(head) + "1.5 1 2 0 0 0 0.7 0.7\n"), ": is a TUM trajectory, not a log" + give);
    EXPECT_THAT(said(std::string(head) + "image: map.pgm\n"), StartsWith(": is the YAML file of a map, not a log;"));
  }
  EXPECT_THAT(said("version https://git-lfs.github.com/spec/v1\noid sha256:0\n"),
              EndsWith("'git lfs pull' fetches that"));
  EXPECT_THAT(said("%time,field.header.seq\n1,2\n"),
              StartsWith(": is text of 'rostopic echo -p', not a log; give the bag"));
  EXPECT_THAT(said("header: \n  seq: 1\n"), StartsWith(": is text of 'rostopic echo', not a log;"));
  EXPECT_THAT(said("[{\"stamp\": 1}]\n"), StartsWith(": is a JSON array, not a log;"));
  for (const char* json : {"{\n \"stamp\": 1\n}\n", "{ \"scans\": [\n1]}\n"}) {
    EXPECT_THAT(said(json), StartsWith(": is JSON over several lines, not a log;"));
  }
}

TEST(WholeFileErrors, OfMeshes) {
  const auto said_of_mesh = [](const std::string& text, const std::string& name) {
    return told_by<InputError>([&] { (void)read_mesh(bytes_of(text), name, {}); }, "no error");
  };
  EXPECT_THAT(said_of_mesh("", "f.gltf"), StartsWith("f.gltf: is not a mesh"));
  EXPECT_THAT(said_of_mesh("solid\n", "f.stl"), StartsWith("f.stl: holds no triangle"));
  EXPECT_THAT(said_of_mesh("hello", "f.stl"), StartsWith("f.stl: is no STL"));
  const std::string ply = "ply\nformat ascii 1.0\n";
  const std::string vertex = "element vertex 1\nproperty float x\nproperty float y\n";
  EXPECT_THAT(said_of_mesh(ply + vertex + "end_header\n0 0\n", "f.ply"), StartsWith("f.ply: its vertices need"));
  EXPECT_THAT(said_of_mesh(ply + "element face 1\nend_header\n", "f.ply"), StartsWith("f.ply: its faces stand before"));
  EXPECT_THAT(
      said_of_mesh(ply + vertex + "property float z\nelement face 1\nproperty int a\nend_header\n0 0 0\n1\n", "f.ply"),
      StartsWith("f.ply: its faces have no list"));
  // A file with a hole of half a gibibyte, which is no STL at all, and one byte more.
  const TemporaryFolder folder;
  const std::string path = folder / "f.stl";
  put_file(path, "hello");
  std::filesystem::resize_file(path, kMaxMeshBytes);
  const auto said = [&path] { return told_by<InputError>([&] { (void)read_mesh(path, {}); }, "no error"); };
  EXPECT_THAT(said(), StartsWith(path + ": is neither STL"));
  std::filesystem::resize_file(path, kMaxMeshBytes + 1);
  EXPECT_EQ(said(), path + ": is longer than the 512 MiB that are read: simplify the mesh");
}

}  // namespace
}  // namespace gdtslam
