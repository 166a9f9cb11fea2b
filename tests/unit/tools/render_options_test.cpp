// The options of `gdtslam render` and what they mean.
#include "tools/gdtslam/render/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/render/views.hpp"

namespace gdtslam {
namespace {

TEST(RenderOptionWords, ScaleHasTheEndsThatAreStated) {
  const OpenRange both = read_scale_range("-50cm:2.5m", CloudColour::kHeight);
  EXPECT_EQ(both.least, -0.5);
  EXPECT_EQ(both.most, 2.5);
  const OpenRange below = read_scale_range(":90deg", CloudColour::kElevation);
  EXPECT_FALSE(below.least);
  EXPECT_DOUBLE_EQ(below.most.value(), rad_from_deg(90.0));
  // Ticks of a scale whose ends are farther apart than numbers reach have no end.
  for (const char* text : {"-1e308m:1e308m", "0m:1.1e12m", "3m:2m", "2m", "1:2"}) {
    EXPECT_THROW(read_scale_range(text, CloudColour::kHeight), UsageError) << text;
  }
}

TEST(RenderOptionWords, PartsPlacesAndTimes) {
  const Hidden hidden = read_hidden("floor,path");
  EXPECT_TRUE(hidden.floor && hidden.path && !hidden.ceiling && !hidden.caption && !hidden.nothing);
  EXPECT_TRUE(read_hidden("none").nothing);
  EXPECT_THROW(read_hidden("none,floor"), UsageError);
  EXPECT_THROW(read_hidden("flor"), UsageError);
  EXPECT_EQ(read_viewpoint("robot").preset, CameraPreset::kFollow);
  EXPECT_EQ(read_viewpoint("1,2,3,4,5,6").camera->eye, Point3(1, 2, 3));
  EXPECT_THROW(read_viewpoint("roof"), UsageError);
  const OpenRange time = read_time_range("20s:");
  EXPECT_EQ(time.least, 20.0);
  EXPECT_FALSE(time.most);
}

}  // namespace
}  // namespace gdtslam
