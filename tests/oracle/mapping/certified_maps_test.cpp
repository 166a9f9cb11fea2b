// Certified matching on whole merged maps, that of the sample log and that of the Intel Research Lab: no bound above
// what brute force finds, and no pose worse. Intel is skipped, visibly, where the log is not there.
#include <string>

#include <gtest/gtest.h>

#include "certified_boxes.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/real_data.hpp"

namespace gdtslam {
namespace {

constexpr double kGap_m = 0.005;

struct KnownScan {
  std::vector<PointCells> points;
  Pose2 T_map_base;
};

// Every `step`-th scan, with its pose.
std::vector<KnownScan> map_log(const std::string& log, std::size_t step, const MapperConfig& config, Mapper& mapper) {
  std::vector<KnownScan> known;
  const auto reader = open_log(log, {});
  std::size_t scans = 0;
  while (const auto record = reader->next()) {
    const auto* const scan = std::get_if<ScanRecord>(&*record);
    if (scan == nullptr) continue;
    const MatchResult match = mapper.process(scan->scan, scan->T_odom_base);
    if (++scans % step != 0 || !match.accepted) continue;
    known.push_back({in_cells(to_points(scan->scan, config.scan), config.map.resolution_m), match.T_map_base});
  }
  return known;
}

// Windows off the pose by up to 0.3 m and 6 degrees, so that the optimum lies anywhere in them.
PoseWindow window_around(const Pose2& T, Random& random) {
  return {
      {T.x_m + random.uniform(-0.3, 0.3), T.y_m + random.uniform(-0.3, 0.3), T.theta_rad + random.uniform(-0.1, 0.1)},
      0.4,
      0.4,
      0.15};
}

void expect_bounds_hold(const CertifiedMap& map, const KnownScan& scan, const PoseWindow& window, std::size_t index) {
  const std::uint32_t optimum = test::searched_optimum(map.field(), scan.points, window, 32, 40);
  const double gap = kGap_m / map.field().resolution_m * 256.0 * static_cast<double>(scan.points.size());
  for (const std::uint64_t limit : {std::uint64_t{1}, std::uint64_t{300}, std::uint64_t{1000}, std::uint64_t{2000}}) {
    CertifiedOptions options{.gap_m = 0.0005};
    options.max_boxes = limit;
    EXPECT_LE(find_pose(map, scan.points, window, options).bound, optimum) << "scan " << index << ", " << limit;
  }
  const CertifiedResult found = find_pose(map, scan.points, window, {.gap_m = kGap_m});
  EXPECT_TRUE(found.certified()) << "scan " << index;
  EXPECT_LE(found.bound, optimum) << "scan " << index;
  EXPECT_LE(found.cost, optimum + gap) << "scan " << index;
}

// What lies around a scan's pose in the map, as the tests of made-up fields have it.
test::Scene scene_around(const GlobalField& map, const KnownScan& scan, Random& random) {
  constexpr std::int32_t kHalf = 360;  // cells
  const CellIndex middle = map_cell_at(scan.T_map_base.translation(), map.geometry().resolution_m);
  test::Scene scene;
  scene.field = {2 * kHalf, 2 * kHalf, map.cap(), {middle.x - kHalf, middle.y - kHalf}, {}};
  for (std::int32_t y = 0; y < 2 * kHalf; ++y) {
    for (std::int32_t x = 0; x < 2 * kHalf; ++x) {
      const bool edge = x < 2 || y < 2 || x >= 2 * kHalf - 2 || y >= 2 * kHalf - 2;
      const CellIndex cell{scene.field.first_cell.x + x, scene.field.first_cell.y + y};
      scene.field.cells.push_back(edge ? map.cap() : map.at(cell));
    }
  }
  scene.T_map_base = scan.T_map_base;
  scene.points = scan.points;
  scene.anchor = middle;
  scene.slack = 0.01F;  // float32 within 5000 cells
  const double r = map.geometry().resolution_m;
  scene.centre = {static_cast<float>(scan.T_map_base.x_m / r - middle.x + random.uniform(-0.4, 0.4)),
                  static_cast<float>(scan.T_map_base.y_m / r - middle.y + random.uniform(-0.4, 0.4)),
                  static_cast<float>(scan.T_map_base.theta_rad + random.uniform(-0.002, 0.002)), 0};
  return scene;
}

void expect_minorants_hold(const GlobalField& map, const KnownScan& scan, std::size_t index, Random& random) {
  constexpr test::BoxSize kPatches[] = {{0.5F, 0.002F}, {0.25F, 0.001F}, {0.03F, 0.0002F}, {0.001F, 1.0e-5F}};
  constexpr test::BoxSize kWide[] = {{1.4F, 0.0F}, {0.5F, 0.0F}, {0.0F, 0.0F}};
  const test::Scene scene = scene_around(map, scan, random);
  test::checked_margin(scene, index, kPatches, test::patch_minorant);
  test::checked_margin(scene, index, kWide, [](const test::Scene& at, const test::BoxSize& size) {
    return test::wide_minorant(at, size, 2);
  });
}

void expect_bounds_hold_on_map_of(const std::string& log, std::size_t step) {
  const MapperConfig config;
  const auto backend = make_cpu_backend({});
  Mapper mapper(config, *backend);
  const std::vector<KnownScan> scans = map_log(log, step, config, mapper);
  ASSERT_GE(scans.size(), 10U);
  const FieldCopy copy(mapper.field());
  const FieldView field = copy.view();
  const CertifiedMap whole(field, backend->host_isa());
  const CertifiedMap near(field, backend->host_isa(), CertifiedMap::kNearWindows);
  Random random(7);
  for (std::size_t index = 0; index < scans.size(); ++index) {
    const PoseWindow window = window_around(scans[index].T_map_base, random);
    expect_bounds_hold(whole, scans[index], window, index);
    expect_bounds_hold(near, scans[index], window, index);
    expect_minorants_hold(mapper.field(), scans[index], index, random);
  }
}

TEST(CertifiedSample, NoBoundLiesAboveWhatBruteForceFinds) {
  expect_bounds_hold_on_map_of(GDTSLAM_SOURCE_DIR "/assets/logs/office-start.log.gz", 30);  // of 350 scans
}

TEST(CertifiedIntel, NoBoundLiesAboveWhatBruteForceFinds) {
  GDTSLAM_REAL_DATA(log, "slam2d/intel.clf.gz");
  expect_bounds_hold_on_map_of(log, 1100);  // of 13,631 scans
}

}  // namespace
}  // namespace gdtslam
