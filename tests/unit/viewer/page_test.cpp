// What a page is made of; tests/cli/browser opens it.
#include "gdtslam/viewer/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <bit>
#include <cmath>
#include <limits>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using ::testing::HasSubstr;

std::string element_of(const std::string& page, const std::string& id) {
  const std::size_t name = page.find("id=\"" + id + "\">");
  if (name == std::string::npos) return "";
  const std::size_t begin = page.find('>', name) + 1;
  return page.substr(begin, page.find('<', begin) - begin);
}

std::vector<std::uint8_t> decoded(const std::string& base64) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t word = 0;
  int bits = 0;
  for (const char c : base64) {
    if (c == '=') break;
    word = word << 6U | static_cast<std::uint32_t>(letters.find(c));
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<std::uint8_t>(word >> static_cast<unsigned>(bits) & 0xFFU));
    }
  }
  return bytes;
}

std::vector<float> floats_of(const std::vector<std::uint8_t>& bytes) {
  std::vector<float> values;
  for (std::size_t k = 0; k + 3 < bytes.size(); k += 4) {
    values.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(bytes[k]) | std::uint32_t{bytes[k + 1]} << 8U |
                                          std::uint32_t{bytes[k + 2]} << 16U | std::uint32_t{bytes[k + 3]} << 24U));
  }
  return values;
}

Cloud slope() {
  Cloud cloud;
  for (std::uint32_t k = 0; k < 500; ++k) {
    const auto at = static_cast<float>(k);
    cloud.push_back({at, 0.5F * at, 0.1F * at, 0.01F * at, 7.0 + k, k});
  }
  return cloud;
}

TEST(Page, RefusesWhatItCannotShow) {
  const Cloud no_points;
  const Trajectory no_poses;
  PageInput input;
  input.cloud = &no_points;
  input.trajectory = &no_poses;
  EXPECT_THROW(make_page({}), InputError);
  EXPECT_THROW(make_page(input), InputError);
  Cloud cloud = slope();
  const std::vector<float> distances(cloud.size() - 1);
  input.cloud = &cloud;
  input.distances_m = &distances;
  EXPECT_THROW(make_page(input), InputError) << "another number of distances";
  input.distances_m = nullptr;
  for (CloudPoint& point : cloud) point.y_m = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(make_page(input), InputError) << "no finite point";
}

TEST(Page, PointsThatAreNotFiniteAreLeftOutAndCounted) {
  Cloud cloud = slope();
  cloud[3].x_m = std::numeric_limits<float>::infinity();
  cloud[9].stamp_s = std::numeric_limits<double>::quiet_NaN();
  PageInput input;
  input.cloud = &cloud;
  const std::string page = make_page(input);
  EXPECT_THAT(page, HasSubstr("\"count\":498,\"of\":500"));
  EXPECT_EQ(decoded(element_of(page, "points-0")).size(), 12U * 498U);
}

/// What the page says of its path.
nlohmann::json path_description_of(const std::string& page) {
  return nlohmann::json::parse(element_of(page, "description")).at("path");
}

/// The second drive begins while the first one lasts, in another room.
TEST(Page, DrivesFollowEachOtherAndNoWayLeadsFromOneToTheNext) {
  const Trajectory trajectory{{100.0, {0.0, 0.0, 0.0}},  {102.0, {1.0, 0.0, 0.0}},  {104.0, {2.0, 0.0, 0.0}},
                              {101.0, {2.0, 40.0, 0.0}}, {104.0, {2.0, 43.0, 0.0}}, {9e8, {9.0, 43.0, 0.0}}};
  PageInput input;
  input.trajectory = &trajectory;
  input.drives = {3, 5};
  const std::string page = make_page(input);
  const nlohmann::json about = path_description_of(page);
  EXPECT_EQ(about.at("drives"), nlohmann::json({3, 5}));
  EXPECT_EQ(about.at("length"), 5.0);
  EXPECT_EQ(about.at("first"), 100.0);
  EXPECT_EQ(about.at("last"), 107.0);
  const std::vector<float> rows = floats_of(decoded(element_of(page, "path")));
  ASSERT_EQ(rows.size(), 24U);
  const std::vector<float> times_s{0.0F, 2.0F, 4.0F, 4.0F, 7.0F, 7.0F};
  for (std::size_t k = 0; k < times_s.size(); ++k) EXPECT_EQ(rows[4 * k + 3], times_s[k]) << k;
  EXPECT_EQ(rows[4 * 3 + 1], 40.0F);
}

/// Times of the poses since the first, as the page has them.
std::vector<float> path_times_s(const std::string& page) {
  const std::vector<float> rows = floats_of(decoded(element_of(page, "path")));
  std::vector<float> times_s;
  for (std::size_t k = 3; k < rows.size(); k += 4) times_s.push_back(rows[k]);
  return times_s;
}

/// In one drive: a clock that steps back, jitter, a wild stamp, and a clock that is set at boot.
TEST(Page, TimeOfAPathNeverStepsBack) {
  struct Case {
    const char* what;
    std::vector<double> stamps_s;
    std::vector<float> times_s;
    int log_times;
  };
  const Case cases[] = {{"whole", {100.0, 102.0, 104.0}, {0.0F, 2.0F, 4.0F}, 1},
                        {"back by 50 s", {100.0, 102.0, 52.0, 55.0}, {0.0F, 2.0F, 2.0F, 5.0F}, 0},
                        {"back to where it began, twice",
                         {100.0, 110.0, 100.0, 110.0, 100.0, 110.0},
                         {0.0F, 10.0F, 10.0F, 20.0F, 20.0F, 30.0F},
                         0},
                        {"jitter of a second", {100.0, 102.0, 101.0, 103.0}, {0.0F, 2.0F, 2.0F, 3.0F}, 1},
                        {"a pause of an hour", {100.0, 3700.0}, {0.0F, 3600.0F}, 1},
                        {"a pause of a day", {100.0, 86500.0}, {0.0F, 86400.0F}, 1},
                        {"more than a day", {100.0, 86501.0}, {0.0F, 0.0F}, 0},
                        {"set at boot", {3.0, 4.0, 1.75e9, 1.75e9 + 2.0}, {0.0F, 1.0F, 1.0F, 3.0F}, 0},
                        {"one wild stamp", {100.0, 101.0, 9e9, 103.0, 104.0}, {0.0F, 1.0F, 1.0F, 1.0F, 2.0F}, 0}};
  for (const Case& one : cases) {
    Trajectory trajectory;
    for (const double stamp_s : one.stamps_s) {
      trajectory.push_back({stamp_s, {static_cast<double>(trajectory.size()), 0.0, 0.0}});
    }
    PageInput input;
    input.trajectory = &trajectory;
    const std::string page = make_page(input);
    const nlohmann::json about = path_description_of(page);
    EXPECT_EQ(path_times_s(page), one.times_s) << one.what;
    EXPECT_EQ(about.at("log_times"), one.log_times) << one.what;
    EXPECT_EQ(about.at("last").get<double>() - about.at("first").get<double>(), one.times_s.back()) << one.what;
    EXPECT_EQ(about.at("length").get<double>(), static_cast<double>(trajectory.size() - 1)) << one.what;
    EXPECT_TRUE(about.at("drives").empty()) << one.what;
  }
}

TEST(Page, AMapOfManyCellsIsMadeSmaller) {
  OccupancyMap map;
  map.geometry = {.resolution_m = 0.05, .origin_x_m = 1.0, .origin_y_m = 2.0, .width = 9001, .height = 4};
  map.cells = CellStates(map.geometry.cell_count());
  map.cells.set(3, CellState::kFree);
  map.cells.set(4, CellState::kOccupied);
  map.cells.set(5, CellState::kFree);
  PageInput input;
  input.map = &map;
  const std::string page = make_page(input);
  EXPECT_THAT(page, HasSubstr("\"width\":3001,\"height\":2,"));
  // Three by three cells: nothing of the first three, occupied beats free in the second.
  EXPECT_EQ(decoded(element_of(page, "map")).front(), (0U | 2U << 2U));
}

}  // namespace
}  // namespace gdtslam
