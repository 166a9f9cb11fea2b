// What of a map is searched: the cells that know a distance, and where the kernels count from.
#include "engine/runs/localizer/map_field.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/map_files.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::uint16_t kCap = 1000;

/// Of half a metre a cell, six cells wide and five high, with its corner at (-2, 3) m; nothing is known of it.
MapField unknown_field() {
  MapField field;
  field.path = "gdt.yaml";
  field.file.geometry = {0.5, -2.0, 3.0, 6, 5};
  field.file.cap = kCap;
  field.file.cells.assign(30, kCap);
  return field;
}

TEST(MapField, TheWindowHoldsTheCellsThatKnowADistance) {
  MapField field = unknown_field();
  EXPECT_THROW(static_cast<void>(field.known_window()), InputError);
  field.file.cells[1 * 6 + 2] = kCap - 1;
  const PoseWindow one = field.known_window();
  EXPECT_EQ(one.centre.x_m, -2.0 + 2.5 * 0.5);
  EXPECT_EQ(one.centre.y_m, 3.0 + 1.5 * 0.5);
  EXPECT_EQ(one.half_x_m, 0.25);
  EXPECT_EQ(one.half_y_m, 0.25);
  EXPECT_EQ(one.half_theta_rad, kPi);
  field.file.cells[3 * 6 + 5] = 0;
  const PoseWindow two = field.known_window();
  EXPECT_EQ(two.centre.x_m, -2.0 + 4.0 * 0.5) << "from column 2 to 5";
  EXPECT_EQ(two.centre.y_m, 3.0 + 2.5 * 0.5) << "from row 1 to 3";
  EXPECT_EQ(two.half_x_m, 1.0);
  EXPECT_EQ(two.half_y_m, 0.75);
}

TEST(MapField, KernelsCountInCellsFromTheirOrigin) {
  MapField field = unknown_field();
  const FieldView from_map = field.view();
  EXPECT_EQ(from_map.first_cell, (CellIndex{-4, 6}));
  EXPECT_EQ(from_map.width, 6U);
  EXPECT_EQ(from_map.height, 5U);
  EXPECT_EQ(from_map.stride, 6U);
  EXPECT_EQ(from_map.cap, kCap);
  EXPECT_EQ(from_map.resolution_m, 0.5);
  field.kernel_origin_m = {-3.0, 4.5};
  EXPECT_EQ(field.view().first_cell, (CellIndex{2, -3}));
}

// A tile's field ends in the middle of the map, where distances are known.
TEST(MapField, AFrameOfTheCapKeepsEachCellInItsPlace) {
  MapField field = unknown_field();
  for (std::size_t k = 0; k < field.file.cells.size(); ++k) field.file.cells[k] = static_cast<std::uint16_t>(k);
  const MapField wide = framed(field);
  const GridGeometry& grid = wide.file.geometry;
  ASSERT_EQ(grid.width, 10);
  ASSERT_EQ(grid.height, 9);
  EXPECT_EQ(wide.file.cap, kCap);
  for (std::int32_t y = 0; y < grid.height; ++y) {
    for (std::int32_t x = 0; x < grid.width; ++x) {
      const CellIndex before = field.file.geometry.cell_at(grid.cell_centre({x, y}));
      const bool is_inside = x >= 2 && x < 8 && y >= 2 && y < 7;
      const std::uint16_t expected = is_inside ? static_cast<std::uint16_t>(before.y * 6 + before.x) : kCap;
      EXPECT_EQ(wide.file.cells[static_cast<std::size_t>(y) * 10 + static_cast<std::size_t>(x)], expected)
          << x << ", " << y;
    }
  }
  EXPECT_EQ(wide.view().first_cell, (CellIndex{-6, 4}));
}

TEST(MapField, AFieldWithItsFrameStaysAsItIs) {
  MapField field = unknown_field();
  field.file.cells[2 * 6 + 2] = field.file.cells[2 * 6 + 3] = 0;  // all that is not of the frame
  EXPECT_EQ(framed(field).file.cells, field.file.cells);
  for (const std::size_t outer : {8U, 20U, 13U, 16U}) {
    MapField open = field;
    open.file.cells[outer] = kCap - 1;
    EXPECT_EQ(framed(open).file.geometry.width, 10) << outer;
  }
}

class MapFieldFiles : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

  /// What is said of a map there; empty where it is taken.
  static std::string fault_of(const std::string& map) {
    try {
      static_cast<void>(read_map_field(map, MapConfig{}));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  std::string fault_of_occupied(const GridGeometry& geometry) {
    OccupancyMap map;
    map.geometry = geometry;
    std::vector<CellState> states(geometry.cell_count(), CellState::kFree);
    states[1] = CellState::kOccupied;
    map.cells = CellStates(states);
    write_occupancy_map(file("map.yaml"), map);
    return fault_of(file("map.yaml"));
  }
  std::string fault_of_distances(const GridGeometry& geometry) {
    const std::vector<std::uint16_t> cells(geometry.cell_count(), 5);
    write_distance_field(file("gdt.yaml"),
                         rows_of(DistanceFieldView{geometry, static_cast<std::size_t>(geometry.width), cells, kCap}));
    return fault_of(file("gdt.yaml"));
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("map_field_test_" + std::to_string(::getpid()));
};

// The corner of an occupancy map need not lie on a cell: its field counts from its own.
TEST_F(MapFieldFiles, AFieldOfOccupiedCellsCountsFromItsCorner) {
  ASSERT_EQ(fault_of_occupied({0.5, 0.3, -0.2, 3, 2}), "");
  const MapField field = read_map_field(file("map.yaml"), MapConfig{});
  EXPECT_EQ(field.source, MapField::Source::kOccupiedCells);
  EXPECT_EQ(field.view().first_cell, (CellIndex{0, 0}));
  ASSERT_EQ(fault_of_distances({0.5, 1.0, -1.0, 3, 2}), "");
  const MapField distances = read_map_field(file("gdt.yaml"), MapConfig{});
  EXPECT_EQ(distances.source, MapField::Source::kDistances);
  EXPECT_EQ(distances.view().first_cell, (CellIndex{2, -2}));
  EXPECT_EQ(read_map_field(folder_.string(), MapConfig{}).path, file("gdt.yaml")) << "of the folder";
}

// docs/formats.md: negate and the thresholds may be missing.
TEST_F(MapFieldFiles, AMapWithoutThresholdsIsAMap) {
  ASSERT_EQ(fault_of_occupied({0.5, 0.3, -0.2, 3, 2}), "");
  std::ifstream whole(file("map.yaml"));
  std::string kept;
  for (std::string line; std::getline(whole, line);) {
    if (line.find("thresh") == std::string::npos && line.find("negate") == std::string::npos) kept += line + "\n";
  }
  whole.close();
  std::ofstream(file("map.yaml")) << kept;
  const MapField field = read_map_field(file("map.yaml"), MapConfig{});
  EXPECT_EQ(field.source, MapField::Source::kOccupiedCells);
}

}  // namespace
}  // namespace gdtslam
