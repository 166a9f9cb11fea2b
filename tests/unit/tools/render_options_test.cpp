// The options of `gdtslam render` as numbers: the ends of a scale.
#include "tools/gdtslam/pictures/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

TEST(ScaleRange, HasTheEndsThatAreStated) {
  const ScaleRange both = scale_range_of("-50cm:2.5m", CloudColour::kHeight);
  EXPECT_EQ(both.least, -0.5);
  EXPECT_EQ(both.most, 2.5);
  const ScaleRange below = scale_range_of(":90deg", CloudColour::kElevation);
  EXPECT_FALSE(below.least);
  EXPECT_DOUBLE_EQ(below.most.value(), rad_from_deg(90.0));
  EXPECT_EQ(scale_range_of("-1e12m:1e12m", CloudColour::kDistance).most, 1e12);
  EXPECT_FALSE(scale_range_of("", CloudColour::kScan).least);
}

// Ticks of a scale whose ends are farther apart than numbers reach, in the unit that it is drawn in, have no end.
TEST(ScaleRange, EndsFartherThanAnyScaleAreRefused) {
  struct FarRange {
    const char* text;
    CloudColour colour;
    const char* named;
  };
  for (const FarRange& range : {FarRange{"-1e308m:1e308m", CloudColour::kHeight, "-1e308m is not"},
                                FarRange{"0m:1.1e12m", CloudColour::kDistance, "1.1e12m is not"},
                                FarRange{"1e17m:", CloudColour::kHeight, "1e17m is not"},
                                FarRange{":-1e308m", CloudColour::kHeight, "-1e308m is not"},
                                FarRange{"-1e308deg:1e308deg", CloudColour::kElevation, "-1e308deg is not"},
                                FarRange{"-1e307rad:", CloudColour::kElevation, "-1e307rad is not"},
                                FarRange{"0s:1e300s", CloudColour::kTime, "1e300s is not"},
                                FarRange{"0:1e300", CloudColour::kScan, "1e300 is not"}}) {
    try {
      static_cast<void>(scale_range_of(range.text, range.colour));
      ADD_FAILURE() << range.text << " was taken";
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(std::string("--range: ") + range.named));
    }
  }
}

}  // namespace
}  // namespace gdtslam
