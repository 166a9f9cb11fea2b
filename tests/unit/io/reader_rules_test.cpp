// Rules of readers that whole files hardly meet: angles as lasers are made, the place in a message, rows of a map.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "engine/io/maps/png.hpp"
#include "engine/mapping/map/keyframe_map.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/io/map_files.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using test::TemporaryFolder;

double start_angle_of(const std::string& written) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.log") << "ROBOTLASER1 0 " << written
                                  << " 3.0 0.0174 80.0 0.01 1 2 3.5 4.5 2 10 20 1.1 2.0 0.0 1.0 2.0 0.0 0.4 0.1 0.5 "
                                     "0.3 1e6 1234.5 host 0.5\n";
  const auto log = open_log(folder / "a.log", {});
  while (const auto record = log->next()) {
    if (const auto* scan = std::get_if<ScanRecord>(&*record)) return scan->scan.first_bearing_rad;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// pi / 180 to more digits than a double has: 0.017453292519943295769.
TEST(CarmenAngles, AreThoseOfTheDegreesThatTheyWereRoundedFrom) {
  constexpr double kDegree = 0.017453292519943295;
  EXPECT_DOUBLE_EQ(start_angle_of("-1.570796327"), -90.0 * kDegree);
  EXPECT_DOUBLE_EQ(start_angle_of("1.570796327"), 90.0 * kDegree);
  EXPECT_DOUBLE_EQ(start_angle_of("-0.004363323"), -0.25 * kDegree);
  EXPECT_EQ(start_angle_of("0.006136012"), 0.006136012) << "0.35156727 of a degree, which has more than four decimals";
  EXPECT_EQ(start_angle_of("-1.57079633"), -1.57079633) << "eight decimals tell too little";
  EXPECT_EQ(start_angle_of("-1.570796329"), -1.570796329) << "2e-9 off, which is no rounding";
  EXPECT_DOUBLE_EQ(start_angle_of("-1.5707963267949"), -90.0 * kDegree);
  EXPECT_EQ(start_angle_of("-1.5707963267959"), -1.5707963267959);
  EXPECT_EQ(start_angle_of("0.000000000"), 0.0);
}

TEST(RowsOfAField, AreTheCellsOfTheMap) {
  SeparateMap map(MapperConfig{});
  std::vector<Point2> points;
  for (int k = 0; k < 40; ++k) points.emplace_back(1.0 + 0.02 * k, 2.0 - 0.03 * k);
  map.merge(points, {0.3, -0.4, 0.7});
  const DistanceFieldRows rows = rows_of(map.field());
  const GridGeometry geometry = map.field().geometry();
  EXPECT_EQ(rows.geometry, geometry);
  const std::vector<std::uint16_t> all = map.field().download();
  const auto width = static_cast<std::size_t>(geometry.width);
  std::vector<std::uint16_t> row(width);
  std::size_t known = 0;
  for (std::int32_t y = 0; y < geometry.height; ++y) {
    rows.read(y, row);
    for (std::size_t x = 0; x < width; ++x) {
      ASSERT_EQ(row[x], all[static_cast<std::size_t>(y) * width + x]) << x << ' ' << y;
      known += row[x] < map.field().cap() ? 1U : 0U;
    }
  }
  EXPECT_GT(known, 1000U) << "within half a metre of the points";
}

}  // namespace
}  // namespace gdtslam
