// What the page of `live` is sent, where this build has one.
#ifdef GDTSLAM_HAS_LIVE_PAGE
#include "tools/gdtslam/live/page/server/page_messages.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

nlohmann::json map_header_of(const Trajectory& path) {
  OccupancyMap map{.geometry = {.resolution_m = 0.1, .width = 3, .height = 2}, .cells = CellStates(6)};
  const std::string message = map_message(map, path, "a-drive");
  const auto size = static_cast<std::size_t>(static_cast<unsigned char>(message[0])) +
                    (static_cast<std::size_t>(static_cast<unsigned char>(message[1])) << 8U) +
                    (static_cast<std::size_t>(static_cast<unsigned char>(message[2])) << 16U);
  return nlohmann::json::parse(message.substr(4, size));
}

/// A path of 4,000 places and more is thinned; where the robot is now stays its end.
TEST(PageMessages, ThePathEndsAtItsLastPose) {
  for (const int poses : {0, 1, 2, 8000, 8001, 12345}) {
    Trajectory path;
    for (int k = 0; k < poses; ++k) path.push_back({0.1 * k, {0.01 * k, 1.0, 0.0}});
    const nlohmann::json places = map_header_of(path).at("path");
    ASSERT_EQ(places.empty(), path.empty());
    EXPECT_EQ(map_header_of(path).at("scans"), poses);
    if (path.empty()) continue;
    EXPECT_EQ(places[0], 0) << poses;
    EXPECT_EQ(places[places.size() - 2], poses - 1) << poses;
    EXPECT_LE(places.size(), 2U * 8001U) << poses;
  }
}

TEST(PageMessages, EachNamesItsDrive) {
  ShownScan shown{.scan = 7, .laser = {}, .valid = {}, .T_map_base = {}, .is_in_doubt = true, .figures = {}};
  shown.figures = [] { return std::vector<std::pair<std::string, std::string>>{{"doubt", "unknown"}}; };
  const nlohmann::json scan = nlohmann::json::parse(scan_message(shown, "a-drive"));
  EXPECT_EQ(scan.at("drive"), "a-drive");
  EXPECT_TRUE(scan.at("pose").is_null());
  EXPECT_EQ(map_header_of({}).at("drive"), "a-drive");
  const nlohmann::json sign = nlohmann::json::parse(sign_of_life_message("a-drive", "a \"log\"\xff"));
  EXPECT_EQ(sign, nlohmann::json({{"drive", "a-drive"}, {"title", "a \"log\"\uFFFD"}}));
}

// A quarter turn a second: the second beam, a second behind the first, looks a quarter turn farther.
TEST(PageMessages, BeamsAreDrawnFromWhereTheyWereMeasured) {
  ShownScan shown{
      .scan = 0, .laser = {}, .valid = {}, .T_map_base = Pose2{10.0, 5.0, 0.0}, .is_in_doubt = false, .figures = {}};
  shown.figures = [] { return std::vector<std::pair<std::string, std::string>>{}; };
  shown.laser.ranges_m = {2.0F, 2.0F};
  shown.laser.beam_period_s = 1.0;
  shown.laser.speed = Eigen::Vector3d(0.0, 0.0, 0.5 * kPi);
  EXPECT_EQ(nlohmann::json::parse(scan_message(shown, "")).at("points"), nlohmann::json({1200, 500, 1000, 700}));
}

TEST(PageMessages, RangesThatDoNotCountAreNotDrawn) {
  ShownScan shown{.scan = 0, .laser = {}, .valid = {}, .T_map_base = Pose2{}, .is_in_doubt = false, .figures = {}};
  shown.figures = [] { return std::vector<std::pair<std::string, std::string>>{}; };
  shown.valid.min_range_m = 0.5;
  shown.valid.max_range_m = 40.0;
  shown.laser.ranges_m = {0.3F, 3.0F, 81.83F, 0.0F, std::numeric_limits<float>::infinity()};  // of unknown limit
  EXPECT_EQ(nlohmann::json::parse(scan_message(shown, "")).at("points"), nlohmann::json({300, 0}));
  shown.laser.max_range_m = 2.5;
  EXPECT_TRUE(nlohmann::json::parse(scan_message(shown, "")).at("points").empty());
}

}  // namespace
}  // namespace gdtslam
#endif
