// Scans searched in occupancy maps as map_server reads them: a drawn building, and the map of a real one. The scans are
// cast in the maps' cells here, from poses drawn at random.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "engine/runs/localizer/run.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/io/map_files.hpp"
#include "occupancy_scans.hpp"
#include "support/real_data.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using test::free_pose;
using test::scan_at;

/// A folder that lives as long as the test.
class LocalizeOccupancy : public ::testing::Test {
 protected:
  LocalizeOccupancy() { fs::create_directories(folder_); }
  ~LocalizeOccupancy() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }

 private:
  fs::path folder_ = fs::temp_directory_path() / ("gdtslam-occupancy-" + std::to_string(::getpid()));
};

/// How many scans of so many were found, each where it was taken.
struct Tally {
  int found = 0;
  int ambiguous = 0;
  double worst_m = 0.0;
  double worst_rad = 0.0;
};

Tally localize_some(const std::string& yaml, int count, std::uint64_t seed) {
  const OccupancyMap map = read_occupancy_map(yaml);
  const std::unique_ptr<Backend> backend = make_cpu_backend({});
  const Localizer localizer(yaml, MapperConfig{}, LocalizeLimits{}, *backend);
  Random random(seed);
  Tally tally;
  for (int k = 0; k < count; ++k) {
    const Pose2 truth = free_pose(map, random);
    const LocalizedScan scan = localizer.localize(scan_at(map, truth, random), static_cast<std::uint64_t>(k));
    EXPECT_TRUE(scan.best.has_value());
    if (!scan.best) continue;
    const double off_m = (scan.best->T_map_base.translation() - truth.translation()).norm();
    const double off_rad = std::fabs(wrap_angle(scan.best->T_map_base.theta_rad - truth.theta_rad));
    SCOPED_TRACE(std::string(to_string(scan.verdict)) + ", " + std::to_string(off_m) + " m off, scan " +
                 std::to_string(k));
    EXPECT_TRUE(scan.verdict == Verdict::kFound || scan.verdict == Verdict::kAmbiguous);
    if (scan.verdict == Verdict::kAmbiguous) ++tally.ambiguous;
    if (scan.verdict != Verdict::kFound) continue;
    ++tally.found;
    tally.worst_m = std::max(tally.worst_m, off_m);
    tally.worst_rad = std::max(tally.worst_rad, off_rad);
  }
  return tally;
}

// The map was scaled down in a picture editor: most of its walls are lighter than the threshold that it states.
TEST_F(LocalizeOccupancy, FindsScansInAMapOfARealBuilding) {
  GDTSLAM_REAL_DATA(image, "maps/willow-2010-02-18-0.10.pgm.gz");
  GDTSLAM_REAL_DATA(description, "maps/willow-2010-02-18-0.10.yaml");
  fs::copy_file(image, file("willow-2010-02-18-0.10.pgm"));
  std::ifstream stated(description);
  std::string yaml{std::istreambuf_iterator<char>(stated), {}};
  const std::string threshold = "occupied_thresh: 0.65";
  ASSERT_NE(yaml.find(threshold), std::string::npos);
  yaml.replace(yaml.find(threshold), threshold.size(), "occupied_thresh: 0.25");
  std::ofstream(file("willow.yaml")) << yaml;
  const Tally tally = localize_some(file("willow.yaml"), 12, 1);
  EXPECT_GE(tally.found, 9) << tally.ambiguous << " ambiguous";
  EXPECT_LT(tally.worst_m, 0.1);  // a cell
  EXPECT_LT(tally.worst_rad, rad_from_deg(1.0));
}

// A hall of 60 m by 60 m in cells of 2.5 cm: more boxes cover it, in all headings, than a robot that waits may open
// beyond them.
TEST_F(LocalizeOccupancy, FindsARobotThatWaitsInALargeHall) {
  OccupancyMap map;
  map.geometry = {0.025, 0.0, 0.0, 2440, 2440};
  map.cells = CellStates(map.geometry.cell_count());
  test::fill(map, {{19, 19}, {2421, 2421}}, CellState::kOccupied);
  test::fill(map, {{20, 20}, {2420, 2420}}, CellState::kFree);
  for (const CellBox box :
       {CellBox{{300, 200}, {420, 600}}, {{1500, 1700}, {1540, 2300}}, {{1900, 400}, {2300, 440}}}) {
    test::fill(map, box, CellState::kOccupied);
  }
  write_occupancy_map(file("hall.yaml"), map);
  const std::unique_ptr<Backend> backend = make_cpu_backend({});
  const Localizer localizer(file("hall.yaml"), MapperConfig{}, LocalizeLimits{}, *backend);
  Random random(5);
  const Pose2 truth{37.0, 24.0, 0.7};
  LaserScan scan = scan_at(map, truth, random);
  const LocalizedScan found = localizer.find(scan, 0);
  ASSERT_EQ(found.verdict, Verdict::kFound);
  ASSERT_TRUE(found.runner_up);
  EXPECT_GT(found.best->boxes, LocalizeLimits::kWaitingBoxes) << "no large hall";
  EXPECT_LT((found.best->T_map_base.translation() - truth.translation()).norm(), 0.05);
}

// Where the search elsewhere was cut short before it had tried a pose, nobody knows that there is none.
TEST(LocalizedScan, IsAmbiguousWhereNothingIsKnownOfElsewhere) {
  LocalizedScan scan;
  scan.best = CertifiedResult{};
  scan.best->mean_cost_m = 0.01;
  EXPECT_EQ(verdict_of(scan, 0.05), Verdict::kFound) << "nobody asked";
  scan.is_elsewhere_open = true;
  EXPECT_EQ(verdict_of(scan, 0.05), Verdict::kAmbiguous);
  scan.best->mean_cost_m = 0.06;
  EXPECT_EQ(verdict_of(scan, 0.05), Verdict::kPoorFit);
}

}  // namespace
}  // namespace gdtslam
