// keyframes.bin.gz: the bytes that Python's struct makes of the same numbers, back again what went in, and one line for
// whatever is cut, damaged or does not fit.
#include "engine/runs/keyframes/run_keyframes.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/io/sha256.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr float kNoReturn = std::numeric_limits<float>::infinity();

RunKeyframes two_keyframes() {
  LaserScan first{.stamp_s = 976052857.337,
                  .first_bearing_rad = -1.5,
                  .bearing_step_rad = 0.0175,
                  .max_range_m = 81.9,
                  .ranges_m = {kNoReturn, 1.234F, 1.2F, 81.91F},
                  .T_base_laser = {0.2, 0.0, -0.01}};
  LaserScan second = first;
  second.stamp_s = 976052858.5;
  second.max_range_m = 0.0;
  second.first_beam_after_s = 0.0125;
  second.beam_period_s = -0.00025;
  second.speed = Eigen::Vector3d(0.5, 0.01, -0.2);
  second.ranges_m = {65.535F, kNoReturn, 0.001F};
  std::string config = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";
  return {.config_sha256 = std::move(config),
          .in_single_precision = true,
          .keyframes = {{.scan = 3, .T_map_base = {1.5, -2.25, 0.1}, .covariance = {}, .laser = std::move(first)},
                        {.scan = 7,
                         .T_map_base = {1.6, -2.5, 3.1},
                         .covariance = PoseCovariance{1.0e-4, -2.0e-6, 3.0e-7, 4.0e-4, 5.0e-8, 6.0e-6},
                         .laser = std::move(second)}}};
}

class KeyframeFileTest : public testing::Test {
 protected:
  void TearDown() override { fs::remove(path_); }
  void put(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
  [[nodiscard]] std::string stored() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  const std::string path_ =
      (fs::temp_directory_path() / ("gdtslam-keyframes-" + std::to_string(::getpid()) + ".gz")).string();
};

// Length and hash: of the same numbers by struct.pack and hashlib in Python, as docs/formats.md describes the file.
TEST_F(KeyframeFileTest, AreTheBytesOfTheFormat) {
  const std::string bytes = keyframe_bytes(two_keyframes());
  EXPECT_EQ(bytes.size(), 385U);
  EXPECT_EQ(Sha256().update(bytes).hex(), "7c07a776a6dde2607773d5209823a462bbc832846848b78b7bee2730d3e787c7");
}

TEST_F(KeyframeFileTest, GivesBackWhatItWasGiven) {
  const RunKeyframes written = two_keyframes();
  write_keyframes(path_, written);
  EXPECT_TRUE(stored().starts_with("\x1f\x8b"));
  EXPECT_EQ(keyframe_bytes(read_keyframes(path_)), keyframe_bytes(written));
}

// Half a millimetre is what a whole one leaves, and what a float of 30 m has itself.
TEST_F(KeyframeFileTest, RangesAreWithinHalfAMillimetre) {
  Random random(17);
  RunKeyframes run = two_keyframes();
  std::vector<float>& ranges_m = run.keyframes.front().laser.ranges_m;
  ranges_m.clear();
  for (int k = 0; k < 20000; ++k) {
    ranges_m.push_back(static_cast<float>(random.uniform(5.0e-4, k % 3 == 0 ? 30.0 : 500.0)));
  }
  const RunKeyframes again = parse_keyframes(keyframe_bytes(run), "run");
  const std::vector<float>& read_m = again.keyframes.front().laser.ranges_m;
  ASSERT_EQ(read_m.size(), ranges_m.size());
  for (std::size_t k = 0; k < read_m.size(); ++k) {
    EXPECT_NEAR(static_cast<double>(read_m[k]), static_cast<double>(ranges_m[k]),
                5.0e-4 + 1.0e-7 * static_cast<double>(ranges_m[k]));
  }
}

TEST_F(KeyframeFileTest, WhatIsNoRangeIsNoReturn) {
  EXPECT_EQ(range_in_mm(kNoReturn), 0U);
  EXPECT_EQ(range_in_mm(-kNoReturn), 0U);
  EXPECT_EQ(range_in_mm(std::numeric_limits<float>::quiet_NaN()), 0U);
  EXPECT_EQ(range_in_mm(-0.5F), 0U);
  EXPECT_EQ(range_in_mm(1.0e5F), 0U);
  EXPECT_EQ(range_in_mm(3.0e38F), 0U);
  EXPECT_EQ(range_in_mm(99999.0F), 99'999'000U);
  EXPECT_EQ(range_in_mm(0.0F), 1U);
  EXPECT_EQ(range_in_mm(0.0014F), 1U);
  EXPECT_EQ(range_in_mm(0.0016F), 2U);
}

TEST_F(KeyframeFileTest, EveryDamagedByteShows) {
  const std::string bytes = keyframe_bytes(two_keyframes());
  const std::string sound = bytes + Sha256().update(bytes).hex();  // without packing: that is read, too
  put(sound);
  EXPECT_NO_THROW((void)read_keyframes(path_));
  for (std::size_t at = 0; at < sound.size(); ++at) {
    std::string damaged = sound;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    put(damaged);
    try {
      (void)read_keyframes(path_);
      ADD_FAILURE() << at << ": nothing was thrown";
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.find(path_), 0U) << what;
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    }
  }
}

}  // namespace
}  // namespace gdtslam
