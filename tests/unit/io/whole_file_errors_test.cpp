// Errors of a file as a whole begin with its name alone; a number behind it would be a line that is not to blame.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/maps/pgm.hpp"
#include "engine/io/maps/png.hpp"
#include "engine/io/meshes/mesh_file.hpp"
#include "engine/io/recordings/recording_reader.hpp"
#include "engine/io/tables/table_reader.hpp"
#include "engine/io/yaml/yaml_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "gdtslam/io/distance_field_file.hpp"
#include "gdtslam/io/log.hpp"
#include "io_test_support.hpp"
#include "mcap_writer.hpp"

namespace gdtslam {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

/// What is said of bytes that are called "f".
using ReadBytesAs = std::function<void(std::span<const std::byte>)>;
std::string said_of(const ReadBytesAs& read, const std::string& bytes) {
  return told_by<InputError>([&] { read(bytes_of(bytes)); }, "no error");
}

TEST(WholeFileErrors, OfLogs) {
  const auto table = [](std::span<const std::byte> data) { drain(*open_table(TableKind::kCsv, data, "f", {})); };
  EXPECT_THAT(said_of(table, "stamp,x,y,theta\n"), StartsWith("f: is a CSV file of 1 lines without a complete row;"));
  const auto rows = [](std::span<const std::byte> data) { drain(*open_table(TableKind::kJsonLines, data, "f", {})); };
  EXPECT_THAT(said_of(rows, "\n\n"), StartsWith("f: is a file of JSON lines of 2 lines without a complete row;"));
  const auto carmen = [](std::span<const std::byte> data) { drain(*open_carmen(data, "f", {})); };
  EXPECT_THAT(said_of(carmen, ""), StartsWith("f: is empty;"));
  EXPECT_THAT(said_of(carmen, std::string("a\0b\n", 4)), StartsWith("f: holds binary data;"));
  EXPECT_THAT(said_of(carmen, "# nothing\n"), StartsWith("f: holds no complete CARMEN message in 1 lines;"));
}

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

TEST(WholeFileErrors, OfRecordings) {
  using namespace test;
  const auto bag = [](std::span<const std::byte> data) { drain(*open_bag(data, "f", {})); };
  EXPECT_THAT(said_of(bag, "#ROSBAG V1.2\n"), StartsWith("f: begins with \"#ROSBAG V1.2\", which is no bag"));
  const auto mcap = [](std::span<const std::byte> data) { drain(*open_mcap(data, "f", {})); };
  EXPECT_EQ(said_of(mcap, mcap_file("")), "f: has no message sensor_msgs/LaserScan; its topics are none");
  EXPECT_THAT(said_of(mcap, mcap_file(mcap_chunk("abc", "rar"))), StartsWith("f: has a chunk packed as \"rar\"; "));
}

TEST(WholeFileErrors, OfClouds) {
  const auto cloud = [](std::span<const std::byte> data) { (void)CloudReader(data, "f").next(); };
  const std::string vertex = "element vertex 2\nproperty float x\nproperty float y\n";
  const std::string ascii = "ply\nformat ascii 1.0\n";
  EXPECT_EQ(said_of(cloud, ""), "f: is empty");
  EXPECT_EQ(said_of(cloud, "obj\n"), "f:1: is neither PLY nor PCD: the first line says neither 'ply' nor '# .PCD'");
  EXPECT_EQ(said_of(cloud, ascii + vertex + "property float x\nend_header\n"), "f: its points have two columns 'x'");
  EXPECT_EQ(said_of(cloud, ascii + vertex + "end_header\n"), "f: its points have no column 'z' of one number");
  EXPECT_THAT(said_of(cloud, ascii + "end_header\n"), StartsWith("f: has no element 'vertex'"));
  EXPECT_THAT(said_of(cloud, ascii + vertex), StartsWith("f: the PLY header has no 'end_header'"));
  EXPECT_THAT(said_of(cloud, "# .PCD v0.7\nFIELDS x y z\n"), StartsWith("f: the PCD header has no DATA line"));
  EXPECT_EQ(said_of(cloud, ascii + vertex + "property float z\nend_header\n1 2 3\n"),
            "f: ends after 1 of the 2 points that its header names");
  const std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\n"
      "property uchar y\nproperty uchar z\nproperty char scan\nend_header\n";
  EXPECT_EQ(said_of(cloud, binary + "abc\xff"), "f: point 0: its scan number is none from 0 to 4294967295");
  EXPECT_EQ(said_of(cloud, binary + "abc\1abc\1"),
            "f: goes on after the 1 points that its header names; correct the "
            "count there");
  const std::string packed = "# .PCD v0.7\nFIELDS x y z\nWIDTH 1\nDATA binary_compressed\n";
  EXPECT_EQ(said_of(cloud, packed + std::string("\4\0\0\0\13\0\0\0", 8)),
            "f: the sizes of its compressed data do not fit its header");
  EXPECT_EQ(said_of(cloud, packed + std::string("\4\0\0\0\14\0\0\0abc", 11)), "f: ends within its compressed data");
  EXPECT_EQ(said_of(cloud, packed + std::string("\1\0\0\0\14\0\0\0\7", 9)), "f: its compressed data are damaged");
}

TEST(WholeFileErrors, OfPictures) {
  const auto pgm = [](std::span<const std::byte> data) { (void)decode_pgm(data, "f"); };
  EXPECT_EQ(said_of(pgm, "P2\n1 1\n255\n0\n"), "f: is no binary PGM image (P5)");
  EXPECT_THAT(said_of(pgm, "P5\n0 1\n255\n"), StartsWith("f: its PGM header has no width from 1 to "));
  EXPECT_EQ(said_of(pgm, "P5\n1 1\n255"), "f: its PGM header does not end in white space");
  EXPECT_EQ(said_of(pgm, "P5\n2 2\n255\nabc"), "f: states 2 x 2 pixels but holds 3; is it cut off?");
  EXPECT_EQ(said_of(pgm, "P5\n2 2\n255\nabcde"), "f: states 2 x 2 pixels but holds 5; remove what follows them");
  const auto png = [](std::span<const std::byte> data) { (void)decode_png_grey16(data, "f", 15); };
  EXPECT_EQ(said_of(png, encode_png(1, 1, std::vector<std::uint8_t>{7, 7, 7, 255})),
            "f: is no 16-bit grey PNG without interlacing");
  const std::string fifteen = encode_png({5, 3, std::vector<std::uint16_t>(15)});
  EXPECT_EQ(said_of(png, fifteen), "no error");
  EXPECT_EQ(said_of(png, encode_png({4, 4, std::vector<std::uint16_t>(16)})),
            "f: has 4 x 4 pixels, more than the 15 that are read");
  EXPECT_THAT(said_of(png, "text"), StartsWith("f: is no readable PNG: "));
  EXPECT_THAT(said_of(png, fifteen.substr(0, fifteen.size() - 20)), StartsWith("f: is a damaged PNG: "));
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

TEST(WholeFileErrors, OfDescriptions) {
  const TemporaryFolder folder;
  const std::string path = folder / "f.yaml";
  const auto said = [&path](const std::string& text, const std::function<void(const DescriptionFile&)>& ask) {
    put_file(path, text);
    return told_by<InputError>([&] { ask(DescriptionFile(path)); }, "no error");
  };
  const auto nothing = [](const DescriptionFile&) {};
  EXPECT_EQ(said("- 1\n", nothing), path + ": is no YAML map of keys and values");
  EXPECT_EQ(said("a: 1\n", [](const DescriptionFile& file) { (void)file.text("b"); }), path + ": the key b is missing");
  EXPECT_EQ(said("resolution: 1\n", [](const DescriptionFile& file) { (void)file.geometry(); }),
            path + ": the key origin is missing");
  EXPECT_THAT(said(std::string(100, '['), nothing), StartsWith(path + ": is not valid YAML: nested too deeply"));
  EXPECT_THAT(said("a: 1\n---\nb: 2\n", nothing), StartsWith(path + ": holds more than one YAML document"));
  EXPECT_THAT(told_by<ConfigError>([] { read_config_text(std::string(kMaxYamlBytes + 1, ' '), "f", {}); }),
              StartsWith("f: is longer than the " + std::to_string(kMaxYamlBytes) + " bytes"));
  EXPECT_EQ(told_by<ConfigError>([] { read_config_text(std::string(kMaxYamlBytes, ' '), "f", {}); }), "");
}

TEST(WholeFileErrors, OfDistanceFields) {
  const TemporaryFolder folder;
  const std::string path = folder / "gdt.yaml";
  const std::vector<std::uint16_t> cells{6};
  const auto said = [&path](const DistanceFieldView& field) {
    return told_by<InputError>([&] { write_distance_field(path, rows_of(field)); }, "no error");
  };
  EXPECT_THAT(said({{0.05, 0, 0, 0, 1}, 0, {}, 5}), StartsWith(path + ": a distance field of 0 x 1 cells"));
  EXPECT_THAT(said({{0.05, 0, 0, 1, 1}, 1, cells, 0}), StartsWith(path + ": a distance field whose cap is 0"));
  EXPECT_THAT(said({{0.05, 0, 0, 1, 1}, 1, cells, 5}), StartsWith(path + ": the distance 6 in row 0 lies above"));
}

}  // namespace
}  // namespace gdtslam
