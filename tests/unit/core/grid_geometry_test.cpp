#include "gdtslam/core/grid_geometry.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace gdtslam {
namespace {

constexpr std::int32_t kLowest = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kHighest = std::numeric_limits<std::int32_t>::max();

// Quarter metres, so that every number here is exact.
constexpr GridGeometry kGrid{.resolution_m = 0.25, .origin_x_m = -1.0, .origin_y_m = 2.0, .width = 8, .height = 4};

TEST(GridGeometry, CellHoldsItsLowerEdgesOnly) {
  EXPECT_EQ(kGrid.cell_at({-1.0, 2.0}), (CellIndex{0, 0}));
  EXPECT_EQ(kGrid.cell_at({-0.75, 2.25}), (CellIndex{1, 1}));
  EXPECT_EQ(kGrid.cell_at({-0.7501, 2.2499}), (CellIndex{0, 0}));
}

TEST(GridGeometry, RoundsDownBelowTheOrigin) {
  EXPECT_EQ(kGrid.cell_at({-1.1, 1.9}), (CellIndex{-1, -1}));
  EXPECT_EQ(kGrid.cell_at({-1.25, 1.75}), (CellIndex{-1, -1}));
  EXPECT_EQ(kGrid.cell_at({-1.26, 1.74}), (CellIndex{-2, -2}));
}

TEST(GridGeometry, CentreIsHalfACellIn) {
  EXPECT_EQ(kGrid.cell_centre({0, 0}), Eigen::Vector2d(-0.875, 2.125));
  EXPECT_EQ(kGrid.cell_centre({7, 3}), Eigen::Vector2d(0.875, 2.875));
  EXPECT_EQ(kGrid.cell_centre({-1, -1}), Eigen::Vector2d(-1.125, 1.875));
}

TEST(GridGeometry, ClampsWhatNoIndexCanSay) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(kGrid.cell_at({1e300, -1e300}), (CellIndex{kHighest, kLowest}));
  EXPECT_EQ(kGrid.cell_at({kInfinite, -kInfinite}), (CellIndex{kHighest, kLowest}));
  EXPECT_EQ(kGrid.cell_at({kNotANumber, kNotANumber}), (CellIndex{kLowest, kLowest}));
  EXPECT_FALSE(kGrid.contains(kGrid.cell_at({kNotANumber, 2.5})));
  EXPECT_FALSE(kGrid.contains(kGrid.cell_at({-0.5, kNotANumber})));
  // The limits themselves and their neighbours.
  const GridGeometry unit{.resolution_m = 1.0};
  EXPECT_EQ(unit.cell_at({2147483647.5, -2147483647.5}), (CellIndex{kHighest, kLowest}));
  EXPECT_EQ(unit.cell_at({2147483646.5, -2147483646.5}), (CellIndex{kHighest - 1, kLowest + 1}));
  EXPECT_EQ(unit.cell_at({2147483648.0, -2147483649.0}), (CellIndex{kHighest, kLowest}));
}

TEST(CellBox, IsHalfOpen) {
  const CellBox box{{1, 2}, {4, 4}};
  EXPECT_EQ(box.width(), 3);
  EXPECT_EQ(box.height(), 2);
  EXPECT_FALSE(box.empty());
  EXPECT_TRUE(box.contains({1, 2}));
  EXPECT_TRUE(box.contains({3, 3}));
  EXPECT_FALSE(box.contains({4, 3}));
  EXPECT_FALSE(box.contains({3, 4}));
  EXPECT_TRUE((CellBox{{1, 2}, {1, 5}}.empty()));
  EXPECT_TRUE((CellBox{{1, 5}, {4, 2}}.empty()));
}

}  // namespace
}  // namespace gdtslam
