// Points of a cloud beside what their beams really met: files of a few points, and distances by hand.
#include "engine/runs/evaluation/hit_errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct HitRow {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double stamp_s = 0.0;
  double range_m = 0.0;
  std::uint32_t scan = 0;
};

class HitErrorsTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  // docs/formats.md: columns of doubles x y z elevation time range, then scan, beam and triangle.
  static std::string bytes_of(const std::vector<HitRow>& rows) {
    std::string bytes;
    const auto put = [&bytes](auto value) {
      char raw[sizeof(value)];
      std::memcpy(raw, &value, sizeof(value));
      bytes.append(raw, sizeof(value));
    };
    for (const HitRow& row : rows) {
      for (const double value : {row.x_m, row.y_m, row.z_m, 0.25, row.stamp_s, row.range_m}) put(value);
      for (const std::uint32_t value : {row.scan, 17U, 4711U}) put(value);
    }
    return bytes;
  }
  static std::string header_for(const std::string& count) {
    return "ply\nformat binary_little_endian 1.0\ncomment true hits of a simulated scan\nelement vertex " + count +
           "\nproperty double x\nproperty double y\nproperty double z\nproperty double elevation\nproperty double "
           "time\n"
           "property double range\nproperty uint scan\nproperty uint beam\nproperty uint triangle\nend_header\n";
  }
  void write_hits(const std::string& bytes) const { std::ofstream(job_.hits, std::ios::binary) << bytes; }
  void write_hits(const std::vector<HitRow>& rows) const {
    write_hits(header_for(std::to_string(rows.size())) + bytes_of(rows));
  }
  void write_cloud(const Cloud& points) const {
    CloudWriter writer(job_.cloud, CloudFormat::kPlyBinary);
    writer.add(points);
    writer.finish();
  }
  static CloudPoint point(float x_m, float y_m, float z_m, double stamp_s, std::uint32_t scan) {
    return {.x_m = x_m, .y_m = y_m, .z_m = z_m, .elevation_rad = 0.0F, .stamp_s = stamp_s, .scan = scan};
  }
  [[nodiscard]] std::string fault() const {
    try {
      static_cast<void>(hit_errors(job_));
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing was thrown";
  }

  const fs::path folder_ = fs::temp_directory_path() / ("gdtslam-hits-" + std::to_string(::getpid()));
  HitErrorsJob job_{.cloud = (folder_ / "cloud.ply").string(), .hits = (folder_ / "hits.ply").string(), .frame = {}};
};

TEST_F(HitErrorsTest, EachPointIsComparedWithItsOwnBeam) {
  write_hits(std::vector<HitRow>{{1.0, 0.0, 0.0, 10.0, 1.0, 0},
                                 {2.0, 0.0, 0.0, 10.001, 2.0, 0},
                                 {0.0, 5.0, 1.0, 12.0, 5.0, 2},
                                 {0.0, 6.0, 1.0, 12.001, 6.0, 2},
                                 {0.0, 0.0, 7.0, 14.0, 7.0, 5}});
  write_cloud({point(1.0F, 0.0F, 0.0F, 10.0, 0),        // where it belongs
               point(2.0F, 0.03125F, 0.0F, 10.001, 0),  // off by 1/32 m
               point(0.0F, 6.0F, 1.5F, 12.001, 2),      // by half a metre, the beam before it left out
               point(0.0F, 0.0F, 7.0F, 13.0, 3),        // of a scan that met nothing
               point(0.75F, 0.0F, 8.0F, 14.0, 5)});     // by 1.25 m
  const HitErrors errors = hit_errors(job_);
  EXPECT_EQ(errors.hits, 5U);
  EXPECT_EQ(errors.without_hit, 1U);
  EXPECT_EQ(errors.distances.count(), 4U);
  EXPECT_DOUBLE_EQ(errors.distances.max_m(), 1.25);
  EXPECT_DOUBLE_EQ(errors.distances.mean_m(), (0.03125 + 0.5 + 1.25) / 4.0);
  EXPECT_FALSE(errors.bound);
  EXPECT_FALSE(errors.interrupted);
}

TEST_F(HitErrorsTest, TheCloudIsPutIntoTheFrameOfTheTruth) {
  write_hits(std::vector<HitRow>{{3.0, 4.0, 0.5, 1.0, 1.0, 0}});
  write_cloud({point(2.0F, 0.0F, 0.5F, 1.0, 0)});
  job_.frame.T_truth_map = {3.0, 2.0, 1.57079632679489662};  // a quarter turn left, then 3 right and 2 up
  EXPECT_NEAR(hit_errors(job_).distances.max_m(), 0.0, 1e-12);
}

TEST_F(HitErrorsTest, StampsOfABeamAgreeToAMicrosecond) {
  write_hits(std::vector<HitRow>{{1.0, 0.0, 0.0, 1.0, 1.0, 0}, {2.0, 0.0, 0.0, 1.00001, 2.0, 0}});
  write_cloud({point(1.0F, 0.0F, 0.0F, 1.0 - 0.9e-6, 0), point(1.0F, 0.0F, 0.0F, 1.0 + 0.9e-6, 0),
               point(1.0F, 0.0F, 0.0F, 1.0 - 1.1e-6, 0), point(1.0F, 0.0F, 0.0F, 1.0 + 1.1e-6, 0),
               point(2.0F, 0.0F, 0.0F, 1.0000091, 0), point(2.0F, 0.0F, 0.0F, 1.000012, 0)});
  const HitErrors errors = hit_errors(job_);
  EXPECT_EQ(errors.distances.count(), 3U);
  EXPECT_EQ(errors.without_hit, 3U);
  EXPECT_EQ(errors.distances.max_m(), 0.0);
}

// At a range of 0 only the range's step and the lever are left of the bound; it grows with the range by steps of 10 cm,
// rounded up (calib::quantisation_bound_m, which has tests of its own).
TEST_F(HitErrorsTest, DistancesAgainstTheBoundAtTheirRange) {
  job_.quantisation = Quantisation{calib::sweep_model_of_preset("paper-a"), 0.01};
  const auto bound_m = [&](double range_m) {
    return calib::quantisation_bound_m(job_.quantisation->model, range_m, 0.01);
  };
  write_hits(
      std::vector<HitRow>{{0.0, 0.0, 0.0, 1.0, 4.95, 0}, {0.0, 0.0, 0.0, 1.1, 5.0, 0}, {0.0, 0.0, 0.0, 1.2, 9.01, 0}});
  const auto half = static_cast<float>(0.5 * bound_m(5.0));
  const auto above = static_cast<float>(1.25 * bound_m(5.0));
  write_cloud({point(half, 0.0F, 0.0F, 1.0, 0), point(above, 0.0F, 0.0F, 1.1, 0), point(0.0F, 0.0F, 0.0F, 1.2, 0)});
  const HitErrors errors = hit_errors(job_);
  ASSERT_TRUE(errors.bound);
  EXPECT_EQ(errors.bound->beyond, 1U);
  EXPECT_NEAR(errors.bound->largest_share, 1.25, 1e-6);
  EXPECT_DOUBLE_EQ(errors.bound->largest_bound_m, bound_m(9.1));
  // Farther than any laser measures the bound is that of 3 km.
  write_hits(std::vector<HitRow>{{0.0, 0.0, 0.0, 1.0, 1.0e9, 0}});
  write_cloud({point(0.0F, 0.0F, 0.0F, 1.0, 0)});
  EXPECT_DOUBLE_EQ(hit_errors(job_).bound->largest_bound_m, bound_m(3000.0));
}

TEST_F(HitErrorsTest, FilesThatDoNotBelongTogether) {
  write_hits(std::vector<HitRow>{{0.0, 0.0, 0.0, 1.0, 1.0, 0}});
  write_cloud({point(0.0F, 0.0F, 0.0F, 7.0, 0)});
  EXPECT_THAT(fault(), HasSubstr("has no point whose beam is in"));
  job_.stop = [] { return true; };
  EXPECT_EQ(fault(), "nothing was thrown") << "an interrupted comparison says nothing";
  std::ofstream(job_.cloud) << "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                               "property float z\nproperty double time\nend_header\n0 0 0 1\n";
  EXPECT_THAT(fault(), HasSubstr("does not tell scan and time of its points"));
  std::ofstream(job_.cloud) << "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                               "property float z\nproperty uint scan\nend_header\n0 0 0 1\n";
  EXPECT_THAT(fault(), HasSubstr("does not tell scan and time of its points"));
}

}  // namespace
}  // namespace gdtslam
