// What the page of `live` is sent, if this build has one.
#ifdef GDTSLAM_HAS_LIVE_PAGE
#include "tools/gdtslam/live/page/server/page_messages.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

ShownScan scan_at(const std::optional<Pose2>& T_map_base) {
  return {.scan = 7, .laser = {}, .valid = {}, .T_map_base = T_map_base, .is_in_doubt = true, .figures = [] {
            return std::vector<std::pair<std::string, std::string>>{{"doubt", "unknown"}};
          }};
}

nlohmann::json message_of(const ShownScan& scan) {
  return nlohmann::json::parse(scan_message({.name = "a-drive", .map = 3}, &scan));
}

TEST(PageMessages, AScanNamesItsDriveAndItsDoubt) {
  const nlohmann::json scan = message_of(scan_at({}));
  EXPECT_EQ(scan.at("drive"), "a-drive");
  EXPECT_EQ(scan.at("map"), 3);
  EXPECT_EQ(scan.at("figures"), nlohmann::json({{"doubt", "unknown"}}));
  EXPECT_TRUE(scan.at("pose").is_null());
}

// A quarter turn a second: the second beam, a second behind the first, looks a quarter turn farther.
TEST(PageMessages, BeamsAreDrawnFromWhereTheyWereMeasured) {
  ShownScan shown = scan_at(Pose2{10.0, 5.0, 0.0});
  shown.laser.ranges_m = {2.0F, 2.0F};
  shown.laser.beam_period_s = 1.0;
  shown.laser.speed = Eigen::Vector3d(0.0, 0.0, 0.5 * kPi);
  EXPECT_EQ(message_of(shown).at("points"), nlohmann::json({1200, 500, 1000, 700}));
}

TEST(PageMessages, RangesThatDoNotCountAreNotDrawn) {
  ShownScan shown = scan_at(Pose2{});
  shown.valid.min_range_m = 0.5;
  shown.valid.max_range_m = 40.0;
  shown.laser.ranges_m = {0.3F, 3.0F, 81.83F, 0.0F, std::numeric_limits<float>::infinity()};  // of unknown limit
  EXPECT_EQ(message_of(shown).at("points"), nlohmann::json({300, 0}));
}

}  // namespace
}  // namespace gdtslam
#endif
