// Certified matching on a real merged map, that of the Intel Research Lab: no bound above what brute force finds, and
// no pose worse. Skipped, visibly, where the log is not there.
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "certified_fields.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kEvery = 1100;  // scans, of 13631
constexpr double kGap_m = 0.005;

struct KnownScan {
  std::vector<PointCells> points;
  Pose2 T_map_base;
};

std::string intel_log() {
  const char* const folder = std::getenv("GDTSLAM_DATA");
  const std::filesystem::path root =
      folder != nullptr ? std::filesystem::path(folder) : std::filesystem::path(GDTSLAM_SOURCE_DIR) / "../shared/data";
  return (root / "slam2d" / "intel.clf.gz").string();
}

std::vector<KnownScan> map_log(const std::string& log, const MapperConfig& config, Mapper& mapper) {
  std::vector<KnownScan> known;
  const auto reader = open_log(log, {});
  std::size_t scans = 0;
  while (const auto record = reader->next()) {
    const auto* const scan = std::get_if<ScanRecord>(&*record);
    if (scan == nullptr) continue;
    const MatchResult match = mapper.process(scan->scan, scan->T_odom_base);
    if (++scans % kEvery != 0 || !match.accepted) continue;
    known.push_back({in_cells(points_of(scan->scan, valid_ranges(config)), config.map.resolution_m), match.T_map_base});
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

TEST(CertifiedIntel, NoBoundLiesAboveWhatBruteForceFinds) {
  const std::string log = intel_log();
  if (!std::filesystem::exists(log)) GTEST_SKIP() << "no " << log << "; set GDTSLAM_DATA";
  const MapperConfig config;
  const auto backend = make_cpu_backend({});
  Mapper mapper(config, *backend);
  const std::vector<KnownScan> scans = map_log(log, config, mapper);
  ASSERT_GE(scans.size(), 10U);
  const FieldView field = field_view(mapper.field());
  const CertifiedMap whole(field, backend->host_isa());
  const CertifiedMap near(field, backend->host_isa(), CertifiedMap::kNearWindows);
  Random random(7);
  for (std::size_t index = 0; index < scans.size(); ++index) {
    const PoseWindow window = window_around(scans[index].T_map_base, random);
    expect_bounds_hold(whole, scans[index], window, index);
    expect_bounds_hold(near, scans[index], window, index);
  }
}

}  // namespace
}  // namespace gdtslam
