// Maps in the form of ROS map_server: our own, somebody else's, and broken ones.
#include "gdtslam/io/map_files.hpp"

#include <gmock/gmock.h>

#include <filesystem>

#include "engine/io/maps/png.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using enum CellState;

constexpr std::string_view kYaml =
    "image: m.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// What reading a map with this YAML and image says.
std::string map_error(std::string_view yaml, std::string_view image) {
  const TemporaryFolder folder;
  put_file(folder / "m.yaml", yaml);
  put_file(folder / "m.pgm", image);
  return told_by<InputError>([&] { read_occupancy_map(folder / "m.yaml"); }, "no error");
}

OccupancyMap read_map(std::string_view yaml, std::string_view image) {
  const TemporaryFolder folder;
  put_file(folder / "m.yaml", yaml);
  put_file(folder / "m.pgm", image);
  return read_occupancy_map(folder / "m.yaml");
}

TEST(OccupancyMapFile, WritesWhatMapServerReads) {
  const TemporaryFolder folder;
  OccupancyMap map;
  map.geometry = {0.05, -0.30000000000000004, 4.0, 3, 2};
  map.cells = CellStates(std::vector{kFree, kOccupied, kUnknown, kOccupied, kOccupied, kFree});
  write_occupancy_map(folder / "map.yaml", map);
  EXPECT_EQ(get_file(folder / "map.yaml"),
            "image: map.pgm\nmode: trinary\nresolution: 0.05\norigin: [-0.30000000000000004, 4.0, 0.0]\nnegate: 0\n"
            "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  // The top row of the picture is the row of the highest y.
  EXPECT_EQ(get_file(folder / "map.pgm"), std::string("P5\n3 2\n255\n") + std::string("\x00\x00\xfe\xfe\x00\xcd", 6));
}

TEST(OccupancyMapFile, LevelsFollowTheThresholds) {
  const std::string image = std::string("P5 4 1 255\n") + '\x00' + '\x59' + '\xcd' + '\xce';
  EXPECT_THAT(read_map(kYaml, image).cells.all(), ElementsAre(kOccupied, kOccupied, kUnknown, kFree));
}

TEST(OccupancyMapFile, NegateTurnsLevelsAround) {
  const std::string image = std::string("P5 2 1 255\n") + '\x00' + '\xff';
  for (const char* word : {"1", "true", "0", "false"}) {
    std::string yaml(kYaml);
    yaml.replace(yaml.find("negate: 0"), 9, std::string("negate: ") + word);
    const bool is_turned = word[0] == '1' || word[0] == 't';
    EXPECT_THAT(read_map(yaml, image).cells.all(),
                is_turned ? ElementsAre(kFree, kOccupied) : ElementsAre(kOccupied, kFree))
        << word;
  }
}

TEST(OccupancyMapFile, ReadsCommentsAndOtherMaxima) {
  const std::string image = std::string("P5\n# made by\n#more\n2 #wide\n 1\n100\n") + '\x64' + '\x00';
  EXPECT_THAT(read_map(kYaml, image).cells.all(), ElementsAre(kFree, kOccupied));
}

TEST(OccupancyMapFile, BadImagesAreInputErrors) {
  EXPECT_THAT(map_error(kYaml, ""), HasSubstr("is no binary PGM image"));
  EXPECT_THAT(map_error(kYaml, "P2\n1 1\n255\n0\n"), HasSubstr("is no binary PGM image"));
  EXPECT_THAT(map_error(kYaml, "P5\n2 2\n255\nabc"), HasSubstr("states 2 x 2 pixels but holds 3"));
  EXPECT_THAT(map_error(kYaml, "P5\n2 2\n255\nabcde"), HasSubstr("holds 5"));
  EXPECT_THAT(map_error(kYaml, "P5\n2147483647 2147483647\n255\n"), HasSubstr("but holds 0"));
  EXPECT_THAT(map_error(kYaml, "P5\n99999999999999999999 1\n255\n"), HasSubstr("width"));
  EXPECT_THAT(map_error(kYaml, "P5\n0 1\n255\n"), HasSubstr("width"));
  EXPECT_THAT(map_error(kYaml, "P5\n1 1\n65535\nab"), HasSubstr("maximum value"));
  EXPECT_THAT(map_error(kYaml, "P5\n1 1\n255"), HasSubstr("white space"));
  EXPECT_THAT(map_error(kYaml, "P5\n# endless comment"), HasSubstr("width"));
}

TEST(OccupancyMapFile, BadDescriptionsNameLineAndKey) {
  const std::string image = std::string("P5 1 1 255\n") + '\x00';
  const auto with = [](std::string_view key, std::string_view line) {
    std::string yaml(kYaml);
    const std::size_t begin = yaml.find(key);
    return yaml.replace(begin, yaml.find('\n', begin) - begin, line);
  };
  EXPECT_THAT(map_error(with("resolution", "x: 1"), image), HasSubstr("the key resolution is missing"));
  EXPECT_THAT(map_error(with("resolution", "resolution: -1"), image),
              HasSubstr("m.yaml:2: resolution: -1 m is not above 0"));
  EXPECT_THAT(map_error(with("resolution", "resolution: .inf"), image), HasSubstr("no finite number"));
  EXPECT_THAT(map_error(with("origin", "origin: [1, 2]"), image), HasSubstr("must be [x, y, yaw]"));
  EXPECT_THAT(map_error(with("origin", "origin: [1, 2, 0.5]"), image), HasSubstr("turned"));
  EXPECT_THAT(map_error(with("free_thresh", "free_thresh: 0.7"), image), HasSubstr("above occupied_thresh"));
  EXPECT_THAT(map_error(with("occupied", "occupied_thresh: 1.5"), image), HasSubstr("outside [0, 1]"));
  EXPECT_THAT(map_error(with("negate", "mode: raw"), image), HasSubstr("only trinary and scale"));
  EXPECT_THAT(map_error("[1, 2", image), HasSubstr("is not valid YAML"));
  EXPECT_THAT(map_error("- 1\n", image), HasSubstr("no YAML map"));
  EXPECT_THAT(map_error(std::string(5000, '['), image), HasSubstr("nested too deeply"));
}

TEST(OccupancyMapFile, ImageOutsideTheFolderIsRefused) {
  for (const char* image : {"../m.pgm", "a/../../m.pgm", "\"\""}) {
    std::string yaml(kYaml);
    yaml.replace(0, yaml.find('\n'), std::string("image: ") + image);
    EXPECT_THAT(map_error(yaml, "x"), HasSubstr("leads out of the folder")) << image;
  }
}

// map_saver writes the name that it was given, and maps are moved.
TEST(OccupancyMapFile, OfAnAbsoluteImageTheFileBesideIsRead) {
  const std::string image = std::string("P5 1 1 255\n") + '\x00';
  const auto with = [](const std::string& name) {
    std::string yaml(kYaml);
    return yaml.replace(0, yaml.find('\n'), "image: " + name);
  };
  const std::string here(kYaml.substr(7, kYaml.find('\n') - 7));
  EXPECT_THAT(read_map(with("/home/else/" + here), image).cells.all(), ElementsAre(kOccupied));
  EXPECT_THAT(map_error(with("/etc/hostname"), image), HasSubstr("\"/etc/hostname\" is an absolute name"));
}

TEST(OccupancyMapFileRealData, WillowGarageLoads) {
  GDTSLAM_REAL_DATA(image, "maps/willow-2010-02-18-0.10.pgm.gz");
  GDTSLAM_REAL_DATA(description, "maps/willow-2010-02-18-0.10.yaml");
  const TemporaryFolder folder;
  std::filesystem::copy_file(image, folder / "willow-2010-02-18-0.10.pgm");  // gzip is seen by content
  std::filesystem::copy_file(description, folder / "willow.yaml");
  const OccupancyMap map = read_occupancy_map(folder / "willow.yaml");
  EXPECT_EQ(map.geometry.width, 566);
  EXPECT_EQ(map.geometry.height, 608);
  EXPECT_EQ(map.geometry.resolution_m, 0.1);
  std::array<std::size_t, 3> counts{};
  for (const CellState cell : map.cells.all()) {
    ++counts.at(static_cast<std::size_t>(cell));
  }
  // Counted with od and awk: levels up to 89 (occupied above 0.65), from 206 on (below 0.196), and the rest.
  EXPECT_EQ(counts[static_cast<std::size_t>(kOccupied)], 544U);
  EXPECT_EQ(counts[static_cast<std::size_t>(kFree)], 109207U);
  EXPECT_EQ(counts[static_cast<std::size_t>(kUnknown)], 234377U);
}

TEST(OccupancyMapFile, PngHasTheSameMap) {
  const TemporaryFolder folder;
  OccupancyMap map{{.resolution_m = 0.05, .origin_x_m = -1.5, .origin_y_m = 2.0, .width = 3, .height = 2}, {}};
  map.cells = CellStates(std::vector<CellState>{kFree, kOccupied, kUnknown, kUnknown, kFree, kOccupied});
  write_occupancy_map(folder / "m.yaml", map, MapImage::kPng);
  EXPECT_TRUE(std::filesystem::exists(folder / "m.png"));
  const OccupancyMap read = read_occupancy_map(folder / "m.yaml");
  EXPECT_EQ(read.geometry, map.geometry);
  EXPECT_EQ(read.cells, map.cells);
}

}  // namespace
}  // namespace gdtslam
