// covariance.csv: what is written comes back bit for bit, and what is no covariance is refused with its line.
#include "engine/runs/folder/loop_files.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

class CovarianceFileTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  [[nodiscard]] std::vector<StampedCovariance> read(const std::string& text) const {
    std::ofstream(path_) << text;
    return read_covariances(path_);
  }

  const std::string path_ =
      std::filesystem::temp_directory_path() / ("gdtslam-covariance-" + std::to_string(::getpid()) + ".csv");
  const std::string header_ = "stamp_s,xx_m2,xy_m2,xt_m_rad,yy_m2,yt_m_rad,tt_rad2\n";
};

TEST_F(CovarianceFileTest, GivesBackTheSameBits) {
  const std::vector<PoseCovariance> written{
      {.xx = 0.1, .xy = -1.0 / 3.0e4, .xt = 1.0e-7 / 7.0, .yy = 2.0 / 3.0, .yt = -0.0, .tt = 1.2345678901234567e-5},
      {}};
  const Trajectory trajectory{{976052857.337, {}}, {976052857.34, {}}};
  const std::string text = covariance_text(trajectory, written);
  EXPECT_TRUE(text.starts_with(header_ + "976052857.337000012,0.1,")) << text;
  const std::vector<StampedCovariance> rows = read(text);
  ASSERT_EQ(rows.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(rows[i].stamp_s, trajectory[i].stamp_s);
    EXPECT_EQ(std::memcmp(&rows[i].covariance, &written[i], sizeof(PoseCovariance)), 0) << i;
  }
}

}  // namespace
}  // namespace gdtslam
