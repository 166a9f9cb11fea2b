// Scans that wait until the end of a drive, in memory and in a file: each comes back as it was put.
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "engine/mapping/back_end/back_end.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "loop_drive.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

float any_number(Random& random) { return static_cast<float>(random.normal(0.0, 10.0)); }

KeptScan any_scan(Random& random, std::size_t surface, std::size_t lone) {
  KeptScan scan;
  for (std::size_t i = 0; i < surface; ++i) {
    scan.surface.push_back(
        {any_number(random), any_number(random), any_number(random), any_number(random), any_number(random)});
  }
  for (std::size_t i = 0; i < lone; ++i) scan.lone.push_back({any_number(random), any_number(random)});
  return scan;
}

void expect_same(const KeptScan& a, const KeptScan& b, std::size_t which) {
  ASSERT_EQ(a.surface.size(), b.surface.size()) << which;
  ASSERT_EQ(a.lone.size(), b.lone.size()) << which;
  for (std::size_t i = 0; i < a.surface.size(); ++i) {
    const SurfacePoint& p = a.surface[i];
    const SurfacePoint& q = b.surface[i];
    EXPECT_TRUE(p.x_m == q.x_m && p.y_m == q.y_m && p.normal_x == q.normal_x && p.normal_y == q.normal_y &&
                p.direction == q.direction)
        << "point " << i << " of scan " << which;
  }
  for (std::size_t i = 0; i < a.lone.size(); ++i) {
    EXPECT_TRUE(a.lone[i].x_m == b.lone[i].x_m && a.lone[i].y_m == b.lone[i].y_m) << i << " of scan " << which;
  }
}

/// Scans with and without points, one of them larger than a page.
std::vector<KeptScan> many_scans() {
  Random random(20);
  std::vector<KeptScan> scans;
  for (std::size_t i = 0; i < 300; ++i) scans.push_back(any_scan(random, i % 37, i % 5 == 0 ? 0 : i % 23));
  scans[40] = any_scan(random, 5000, 10);
  scans[41] = {};
  return scans;
}

void expect_all_back(const Shelf<KeptScan>& shelf, const std::vector<KeptScan>& scans) {
  ASSERT_EQ(shelf.bytes().size(), scans.size());
  for (int round = 0; round < 2; ++round) {
    Shelf<KeptScan>::Reader reader(shelf);
    for (std::size_t i = 0; i < scans.size(); ++i) expect_same(reader.next(), scans[i], i);
  }
}

std::size_t bytes_of(const std::vector<KeptScan>& scans) {
  std::size_t bytes = 0;
  for (const KeptScan& scan : scans) bytes += scan.bytes();
  return bytes;
}

TEST(ScanShelf, GivesBackWhatWasPut) {
  const std::vector<KeptScan> scans = many_scans();
  for (const std::size_t memory_bytes : {std::size_t{0}, std::size_t{20'000}, ByteShelf::kMemoryBytes}) {
    Shelf<KeptScan> shelf(testing::TempDir(), memory_bytes);
    for (const KeptScan& scan : scans) shelf.put(scan);
    EXPECT_EQ(shelf.bytes().trouble(), "");
    if (memory_bytes == ByteShelf::kMemoryBytes) {
      EXPECT_EQ(shelf.bytes().bytes_in_file(), 0U);
    } else {  // but for the page in hand, of a sixteenth of the memory or of the last scan
      EXPECT_GE(shelf.bytes().bytes_in_file() + memory_bytes + 1250 + 20 * 40, bytes_of(scans));
    }
    expect_all_back(shelf, scans);
  }
}

TEST(ScanShelf, StaysInMemoryWhereThereIsNoFolder) {
  const std::vector<KeptScan> scans = many_scans();
  Shelf<KeptScan> shelf(testing::TempDir() + "no-such-folder", 0);
  for (const KeptScan& scan : scans) shelf.put(scan);
  EXPECT_EQ(shelf.bytes().bytes_in_file(), 0U);
  EXPECT_NE(shelf.bytes().trouble().find("no-such-folder: takes no file"), std::string::npos)
      << shelf.bytes().trouble();
  expect_all_back(shelf, scans);
}

/// The path after the end of a drive through a room whose odometry falls short by a tenth.
std::vector<Pose2> path_with(const BackEndOptions& options, std::vector<std::string>* warnings = nullptr) {
  BackEndOptions with_warnings = options;
  with_warnings.live.is_beside = false;
  with_warnings.live.warn = [&](const std::string& text) {
    if (warnings != nullptr) warnings->push_back(text);
  };
  const std::unique_ptr<Backend> backend = make_cpu_backend({});
  Mapper mapper({}, *backend);
  BackEnd back_end(with_warnings);
  const std::vector<Pose2> truth = test::drive_through_room();
  const std::vector<Pose2> odometry = test::odometry_short_by_a_tenth(truth);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const LaserScan scan = test::scan_of(test::furnished_room(), truth[i], 0.1 * static_cast<double>(i));
    back_end.take(keep_scan(to_points(scan, {})), mapper.process(scan, odometry[i]));
  }
  return back_end.finish([](std::string_view, double) {}).poses;
}

void expect_same_path(const std::vector<Pose2>& a, const std::vector<Pose2>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(a[i].x_m == b[i].x_m && a[i].y_m == b[i].y_m && a[i].theta_rad == b[i].theta_rad) << i;
  }
}

TEST(ScanShelf, APathIsTheSameWhereItsScansWaitInAFile) {
  const std::vector<Pose2> in_memory = path_with({});
  for (const unsigned threads : {1U, 3U}) {
    BackEndOptions options;
    options.threads = threads;
    options.scratch_folder = testing::TempDir();
    options.shelf_bytes = 0;
    std::vector<std::string> warnings;
    expect_same_path(path_with(options, &warnings), in_memory);
    EXPECT_TRUE(warnings.empty()) << warnings.front();
    options.scratch_folder += "no-such-folder";
    expect_same_path(path_with(options, &warnings), in_memory);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("stayed in memory"), std::string::npos) << warnings[0];
  }
}

}  // namespace
}  // namespace gdtslam
