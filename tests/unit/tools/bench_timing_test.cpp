// How the benchmark sums up its samples.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tools/lab/bench/report.hpp"
#include "tools/lab/bench/rows.hpp"

namespace gdtslam {
namespace {

// The upper one of the two in the middle, so that a row of two samples does not tell its faster one.
TEST(BenchTiming, TheMedianOfTwoSamplesIsTheSlowerOne) {
  constexpr std::array<double, 3> kDevice_ns{7e9, 1e9, 3e9};  // of the trial, then of both samples
  std::size_t done = 0;
  const Work work{.step = [] {}, .device_ns = [&] { return kDevice_ns.at(done++); }};
  const Timing timing = measure(work, {.samples = 2, .sample_s = 0.0});
  EXPECT_EQ(timing.samples, 2);
  ASSERT_TRUE(timing.device_s.has_value());
  EXPECT_DOUBLE_EQ(*timing.device_s, 3.0);
}

TEST(BenchTiming, ADeviceWhoseClockFailsOnceTellsNoTime) {
  constexpr std::array<double, 4> kDevice_ns{7e9, 1e9, -1.0, 3e9};  // of the trial, then of the samples
  std::size_t done = 0;
  const Work work{.step = [] {}, .device_ns = [&] { return kDevice_ns.at(done++); }};
  const Timing timing = measure(work, {.samples = 3, .sample_s = 0.0});
  EXPECT_FALSE(timing.device_s.has_value());
  EXPECT_TRUE(timing.device_samples_s.empty());
}

TEST(BenchTiming, WithoutTheDevicesTimeARowIsOnWallTime) {
  BenchRow row;
  Timing& timing = row.timing;
  timing.wall_s = 2.0;
  timing.wall_samples_s = {2.0};
  EXPECT_EQ(basis_of(timing, Basis::kDevice), Basis::kWall);
  EXPECT_EQ(basis_of(timing, Basis::kCpu), Basis::kCpu);
  const Measured measured{"vulkan:0", {}, {}, Basis::kDevice, {row}};
  const nlohmann::ordered_json json = bench_json({measured, measured});
  for (const auto& line : json["rows"]) {
    EXPECT_EQ(line["basis"], "wall");
    EXPECT_EQ(line["samples_s"], nlohmann::ordered_json({2.0}));
  }
  timing.device_s = 1.0;
  EXPECT_EQ(basis_of(timing, Basis::kDevice), Basis::kDevice);
}

TEST(BenchOrder, ComesByEachOnce) {
  for (std::size_t count = 1; count < 200; ++count) {
    const std::size_t stride = spreading_stride(count);
    std::set<std::size_t> met;
    for (std::size_t k = 0; k < count; ++k) met.insert(k * stride % count);
    EXPECT_EQ(met.size(), count) << count;
  }
}

// 4 bytes a cell: 5792 cells a side take 134,189,056 bytes, 5793 cells in rows of 5796 or more take 134,304,912.
TEST(BenchSizes, ATransformFitsIntoTheDevicesBuffers) {
  EXPECT_EQ(largest_transform(std::size_t{1} << 27U, 8192), 5792U);
  EXPECT_EQ(largest_transform(134189056, 8192), 5792U);
  EXPECT_LT(largest_transform(134189055, 8192), 5792U);
  EXPECT_EQ(largest_transform(std::size_t{1} << 28U, 8192), 8192U);
  EXPECT_EQ(largest_transform(std::size_t{1} << 28U, 1024), 1024U);
}

TEST(BenchClouds, WhatOthersDoIsAPeer) {
  std::size_t peers = 0;
  for (const BenchRow& row : bench_clouds({.samples = 1, .sample_s = 0.0})) {
    const bool is_peer = row.variant.find("fwrite") != std::string::npos ||
                         row.variant.find("fread") != std::string::npos ||
                         row.variant.find("unordered_set") != std::string::npos;
    peers += is_peer ? 1U : 0U;
    EXPECT_EQ(row.group, is_peer ? "peer" : "cloud") << row.variant;
  }
  EXPECT_EQ(peers, 3U);
}

}  // namespace
}  // namespace gdtslam
