// Certified matching with a device for the boxes that it begins with: every number of the result is the host's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

constexpr double kResolution_m = 0.05;
constexpr std::uint16_t kCap = 5120;
constexpr std::uint32_t kFieldWidth = 390;
constexpr std::uint32_t kFieldHeight = 301;
constexpr CellIndex kFirst{-57, 23};  // the map's lower left cell

/// A wall along x or y, in cells from the field's corner.
struct FieldWall {
  double x0, y0, x1, y1;
};
constexpr FieldWall kWalls[] = {{30, 25, 360, 25},    {30, 270, 250, 270},  {30, 25, 30, 270},    {360, 25, 360, 200},
                                {250, 200, 360, 200}, {250, 200, 250, 270}, {120, 25, 120, 110},  {120, 150, 120, 270},
                                {200, 110, 290, 110}, {290, 60, 290, 110},  {165, 180, 185, 180}, {185, 180, 185, 205}};

double distance_to(const FieldWall& wall, double x, double y) {
  const double dx = x - std::clamp(x, wall.x0, wall.x1);
  const double dy = y - std::clamp(y, wall.y0, wall.y1);
  return std::sqrt(dx * dx + dy * dy);
}

std::vector<std::uint16_t> walls_field() {
  std::vector<std::uint16_t> field(std::size_t{kFieldWidth} * kFieldHeight, kCap);
  for (std::uint32_t y = 2; y + 2 < kFieldHeight; ++y) {
    for (std::uint32_t x = 2; x + 2 < kFieldWidth; ++x) {
      double least = 20.0;
      for (const FieldWall& wall : kWalls) least = std::min(least, distance_to(wall, x + 0.5, y + 0.5));
      field[std::size_t{y} * kFieldWidth + x] = static_cast<std::uint16_t>(std::lround(256.0 * least));
    }
  }
  return field;
}

/// Points on the walls as they are seen from a pose, some of them on nothing.
std::vector<PointCells> seen_from(const Pose2& T_map_base, std::size_t count, Random& random) {
  const auto [s, c] = sin_cos(T_map_base.theta_rad);
  std::vector<PointCells> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const FieldWall& wall = kWalls[random.below(std::size(kWalls))];
    const double along = random.uniform(0.0, 1.0);
    const double stray = i % 9 == 0 ? 15.0 : 0.2;
    const double x = wall.x0 + along * (wall.x1 - wall.x0) + random.uniform(-stray, stray) + kFirst.x;
    const double y = wall.y0 + along * (wall.y1 - wall.y0) + random.uniform(-stray, stray) + kFirst.y;
    const double dx = x - T_map_base.x_m / kResolution_m;
    const double dy = y - T_map_base.y_m / kResolution_m;
    points[i] = {static_cast<float>(c * dx + s * dy), static_cast<float>(c * dy - s * dx)};
  }
  return points;
}

struct Problem {
  std::vector<PointCells> points;
  PoseWindow window;
  CertifiedOptions options;
};

/// Of the whole map and all headings, of half of both, and of more than the map; with priors and places that do not
/// count.
Problem make_problem(std::uint64_t seed) {
  Random random(seed);
  const Pose2 truth{(kFirst.x + random.uniform(40.0, 240.0)) * kResolution_m,
                    (kFirst.y + random.uniform(35.0, 260.0)) * kResolution_m, random.uniform(-3.1, 3.1)};
  Problem problem;
  problem.points = seen_from(truth, 240 + 40 * (seed % 5), random);
  const Pose2 middle{(kFirst.x + 0.5 * kFieldWidth) * kResolution_m, (kFirst.y + 0.5 * kFieldHeight) * kResolution_m,
                     0.0};
  constexpr double kWholeX_m = 0.5 * kFieldWidth * kResolution_m;
  constexpr double kWholeY_m = 0.5 * kFieldHeight * kResolution_m;
  problem.window = {middle, kWholeX_m, kWholeY_m, kPi};
  if (seed % 3 == 1) problem.window = {truth, 5.0, 4.0, 1.7};
  if (seed % 3 == 2) problem.window = {middle, 3.0 * kWholeX_m, 3.0 * kWholeY_m, kPi};
  problem.options.gap_m = 0.01;
  problem.options.max_boxes = 400000;
  if (seed % 4 == 3) problem.options.prior = WindowPrior{.mean = truth, .weight_xy = 3.0F, .weight_theta = 400.0F};
  if (seed % 4 == 2) problem.options.excluded = {{.around = truth}};
  return problem;
}

void expect_equal(const CertifiedResult& found, const CertifiedResult& expected, std::uint64_t seed) {
  EXPECT_EQ(found.T_map_base, expected.T_map_base) << "seed " << seed;
  EXPECT_EQ(found.cost, expected.cost) << "seed " << seed;
  EXPECT_EQ(found.bound, expected.bound) << "seed " << seed;
  EXPECT_EQ(found.boxes, expected.boxes) << "seed " << seed;
  EXPECT_EQ(found.evaluations, expected.evaluations) << "seed " << seed;
  EXPECT_EQ(found.stop, expected.stop) << "seed " << seed;
  EXPECT_EQ(found.mean_cost_m, expected.mean_cost_m) << "seed " << seed;
  EXPECT_EQ(found.mean_bound_m, expected.mean_bound_m) << "seed " << seed;
  EXPECT_EQ(found.gap_m, expected.gap_m) << "seed " << seed;
}

class CertifiedOnDevice : public testing::Test {
 protected:
  CertifiedResult on_host(const Problem& problem) const {
    return find_pose(host, problem.points, problem.window, problem.options);
  }
  /// All problems, one launch for each.
  void expect_the_hosts_results(Backend& backend) const {
    const CertifiedMap map(view, best_isa(), CertifiedMap::kAnyWindows, &backend);
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      const Problem problem = make_problem(seed);
      const std::uint64_t dispatches = backend.dispatch_count();
      expect_equal(find_pose(map, problem.points, problem.window, problem.options), on_host(problem), seed);
      EXPECT_EQ(backend.dispatch_count() - dispatches, 1U) << "seed " << seed;
      EXPECT_EQ(map.device_launches(), seed + 1);
    }
  }

  const std::vector<std::uint16_t> cells = walls_field();
  const FieldView view{cells.data(), kFieldWidth, kFieldHeight, kFieldWidth, kFirst, kCap, kResolution_m};
  const CertifiedMap host{view, best_isa()};
};

class CertifiedOnVulkan : public CertifiedOnDevice {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
};

TEST_F(CertifiedOnVulkan, GivesTheHostsResult) {
  const auto backend = test_backend();
  expect_the_hosts_results(*backend);
  EXPECT_EQ(backend->submit_count(), 12U);
}

// A deliberate fault: with bounds that are too low in every other column the search would take more boxes.
TEST_F(CertifiedOnVulkan, SeesAConstantThatIsWrong) {
  constexpr std::uint32_t kRight = 0x00FF00FF;
  constexpr std::uint32_t kWrong = 0x00FF000F;
  std::size_t edits = 0;
  VulkanOptions options;
  options.edit_shader = [&](std::string_view, std::vector<std::uint32_t>& spirv) {
    edits += static_cast<std::size_t>(std::count(spirv.begin(), spirv.end(), kRight));
    std::replace(spirv.begin(), spirv.end(), kRight, kWrong);
  };
  const auto backend = test_backend(options);
  const CertifiedMap map(view, best_isa(), CertifiedMap::kAnyWindows, backend.get());
  const Problem problem = make_problem(0);
  const CertifiedResult found = find_pose(map, problem.points, problem.window, problem.options);
  EXPECT_GT(edits, 0U);
  EXPECT_GT(found.boxes, on_host(problem).boxes);
}

// Every step of a search may be the one that loses the device: the search ends with its error, or with the result.
TEST_F(CertifiedOnDevice, EndsWithTheErrorOfTheDevice) {
  GDTSLAM_NEEDS_VULKAN();
  const Problem problem = make_problem(1);
  const CertifiedResult expected = on_host(problem);
  const auto search_on = [&](VulkanBackend& backend) {
    const CertifiedMap map(view, best_isa(), CertifiedMap::kAnyWindows, &backend);
    return find_pose(map, problem.points, problem.window, problem.options);
  };
  const auto is_lost = [&](std::uint64_t at) {
    const auto backend = test_backend({.lost_at = at});
    try {
      expect_equal(search_on(*backend), expected, at);
      return false;
    } catch (const DeviceError&) {
      return true;
    }
  };
  std::uint64_t at = 2;
  while (is_lost(at)) ++at;
  EXPECT_GT(at, 8U);
}

TEST_F(CertifiedOnDevice, ThreadsOfTheCpuGiveTheHostsResult) {
  const auto backend = make_cpu_backend({.threads = 3, .isa = std::nullopt});
  expect_the_hosts_results(*backend);
}

// Threads that share a map take turns with its device.
TEST_F(CertifiedOnVulkan, ThreadsMayShareTheMap) {
  constexpr std::size_t kThreads = 4;
  constexpr std::uint64_t kSeeds = 8;
  const auto backend = test_backend();
  const CertifiedMap map(view, best_isa(), CertifiedMap::kAnyWindows, backend.get());
  std::vector<CertifiedResult> found(kSeeds);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (std::uint64_t seed = t; seed < kSeeds; seed += kThreads) {
        const Problem problem = make_problem(seed);
        found[seed] = find_pose(map, problem.points, problem.window, problem.options);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) expect_equal(found[seed], on_host(make_problem(seed)), seed);
  EXPECT_EQ(map.device_launches(), kSeeds);
}

// What the host does sooner than a device answers stays there.
TEST_F(CertifiedOnDevice, SmallWindowsStayOnTheHost) {
  const auto backend = make_cpu_backend({});
  const CertifiedMap map(view, best_isa(), CertifiedMap::kAnyWindows, backend.get());
  Problem problem = make_problem(0);
  problem.window = {problem.window.centre, 0.5, 0.5, 0.3};
  expect_equal(find_pose(map, problem.points, problem.window, problem.options), on_host(problem), 0);
  EXPECT_EQ(backend->dispatch_count(), 0U);
  EXPECT_EQ(map.device_launches(), 0U);
}

// More boxes than a launch takes, and a map that lies far off.
TEST_F(CertifiedOnDevice, HugeWindowsTakeSeveralLaunches) {
  const auto backend = make_cpu_backend({.threads = 2, .isa = std::nullopt});
  const CertifiedMap map(view, best_isa(), CertifiedMap::kAnyWindows, backend.get());
  Problem problem = make_problem(3);
  problem.window = {{300.0, -200.0, 0.0}, 500.0, 400.0, 0.5};
  problem.options.max_boxes = 1000;
  expect_equal(find_pose(map, problem.points, problem.window, problem.options), on_host(problem), 3);
  EXPECT_GT(map.device_launches(), 1U);
}

}  // namespace
}  // namespace gdtslam::test
