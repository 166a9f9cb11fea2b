// Programs that were compiled with an older or a newer gdtslam.h than the library.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <vector>

#include "c_support.hpp"

namespace gdtslam::c {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

class CStructs : public ::testing::Test {
 protected:
  void SetUp() override {
    gdtslam_mapper* mapper = nullptr;
    ASSERT_EQ(gdtslam_mapper_new(nullptr, &mapper, &error_), GDTSLAM_OK) << error_.text;
    mapper_.reset(mapper);
    scan_.first_bearing_rad = -1.0;
    scan_.bearing_step_rad = 0.02;
    scan_.ranges_m = ranges_.data();
    scan_.range_count = ranges_.size();
  }
  gdtslam_status process(gdtslam_match* match) { return gdtslam_mapper_process(mapper_.get(), &scan_, match, &error_); }

  std::vector<float> ranges_ = std::vector<float>(100, 5.0F);
  gdtslam_scan scan_ = made<gdtslam_scan>();
  gdtslam_error error_ = made<gdtslam_error>();
  Owned<gdtslam_mapper> mapper_;
};

TEST_F(CStructs, what_an_older_program_does_not_have_is_the_default) {
  scan_.size = offsetof(gdtslam_scan, max_range_m);
  scan_.max_range_m = std::numeric_limits<double>::quiet_NaN();  // behind its end: whatever is there
  scan_.has_odometry = 1;
  EXPECT_EQ(process(nullptr), GDTSLAM_OK) << error_.text;
}

TEST_F(CStructs, what_every_program_has_is_needed) {
  scan_.size = offsetof(gdtslam_scan, range_count);
  EXPECT_EQ(process(nullptr), GDTSLAM_USAGE);
  EXPECT_THAT(error_.text, EndsWith("begin with GDTSLAM_INIT"));
  scan_.size = 0;
  EXPECT_EQ(process(nullptr), GDTSLAM_USAGE);
}

TEST_F(CStructs, what_a_newer_program_asks_for_is_refused_unless_it_is_the_default) {
  struct {
    gdtslam_scan scan;
    double more;
  } newer{scan_, 0.0};
  newer.scan.size = sizeof(newer);
  EXPECT_EQ(gdtslam_mapper_process(mapper_.get(), &newer.scan, nullptr, &error_), GDTSLAM_OK) << error_.text;
  newer.more = 1.0;
  EXPECT_EQ(gdtslam_mapper_process(mapper_.get(), &newer.scan, nullptr, &error_), GDTSLAM_USAGE);
  EXPECT_THAT(error_.text, HasSubstr(gdtslam_version()));
}

TEST_F(CStructs, of_a_result_only_what_the_program_has_is_written) {
  gdtslam_match match;
  std::memset(&match, 0x5A, sizeof(match));
  match.size = offsetof(gdtslam_match, correction);
  ASSERT_EQ(process(&match), GDTSLAM_OK) << error_.text;
  EXPECT_EQ(match.T_map_base.x_m, 0.0);
  EXPECT_EQ(match.size, offsetof(gdtslam_match, correction));
  unsigned char behind = 0;
  std::memcpy(&behind, &match.correction, 1);
  EXPECT_EQ(behind, 0x5A);
}

TEST_F(CStructs, of_a_result_what_the_library_does_not_have_is_zero) {
  struct {
    gdtslam_match match;
    double more;
  } newer{made<gdtslam_match>(), 1.0};
  newer.match.size = sizeof(newer);
  ASSERT_EQ(process(&newer.match), GDTSLAM_OK) << error_.text;
  EXPECT_EQ(newer.more, 0.0);
  EXPECT_EQ(newer.match.points, 100U);
}

TEST_F(CStructs, a_result_without_room_is_refused_before_the_scan_counts) {
  gdtslam_match match{};
  EXPECT_EQ(process(&match), GDTSLAM_USAGE);
  const gdtslam_stamped_pose* poses = nullptr;
  std::size_t count = 1;
  ASSERT_EQ(gdtslam_mapper_trajectory(mapper_.get(), &poses, &count, &error_), GDTSLAM_OK);
  EXPECT_EQ(count, 0U);
}

TEST_F(CStructs, numbers_of_a_scan_must_be_finite_and_its_ranges_there) {
  scan_.stamp_s = std::numeric_limits<double>::infinity();
  EXPECT_EQ(process(nullptr), GDTSLAM_BAD_INPUT);
  scan_.stamp_s = 0.0;
  scan_.T_base_laser.theta_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(process(nullptr), GDTSLAM_BAD_INPUT);
  scan_.T_base_laser.theta_rad = 0.0;
  scan_.ranges_m = nullptr;
  EXPECT_EQ(process(nullptr), GDTSLAM_USAGE);
  scan_.range_count = 0;
  EXPECT_EQ(process(nullptr), GDTSLAM_OK) << "a scan without beams is none of the mapper's faults";
  scan_.range_count = std::numeric_limits<std::size_t>::max();
  EXPECT_EQ(process(nullptr), GDTSLAM_BAD_INPUT);
}

}  // namespace
}  // namespace gdtslam::c
