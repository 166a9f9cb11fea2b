// Closing the loops of a short drive through a known room, and not closing them.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "gdtslam/mapping/mapper.hpp"
#include "loop_drive.hpp"
#include "support/room.hpp"

namespace gdtslam {
namespace {

class LoopsOfARoom : public testing::Test {
 protected:
  // With odometry that falls short by a tenth.
  void drive(Mapper& mapper) {
    const std::vector<test::Segment> walls = test::furnished_room();
    const std::vector<Pose2> truth = test::drive_through_room();
    const std::vector<Pose2> odometry = test::odometry_short_by_a_tenth(truth);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const LaserScan scan = test::scan_of(walls, truth[i], 0.1 * static_cast<double>(i));
      front_end_.push_back(mapper.process(scan, odometry[i]).T_map_base);
      truth_.push_back(between(truth.front(), truth[i]));
    }
  }

  std::unique_ptr<Backend> backend_ = make_cpu_backend({});
  std::vector<Pose2> front_end_;
  std::vector<Pose2> truth_;
};

TEST_F(LoopsOfARoom, GivesAPoseAndACovarianceAScan) {
  Mapper mapper({}, *backend_, {.with_loops = true});
  drive(mapper);
  std::vector<std::string> steps;
  const ClosedPath path = mapper.loops()->close(
      [&](std::string_view step, double share) {
        if (steps.empty() || steps.back() != step) steps.emplace_back(step);
        EXPECT_GT(share, 0.0);
        EXPECT_LE(share, 1.0);
      },
      [] { return false; });
  EXPECT_TRUE(path.is_closed);
  EXPECT_EQ(steps.back(), "adjusting scans");
  ASSERT_EQ(path.T_map_base.size(), truth_.size());
  ASSERT_EQ(path.covariances.size(), truth_.size());
  EXPECT_LT(path.T_map_base.front().translation().norm(), 1.0e-12) << "the map's origin";
  EXPECT_LT(std::fabs(path.T_map_base.front().theta_rad), 1.0e-12);
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    EXPECT_LT((path.T_map_base[i].translation() - truth_[i].translation()).norm(), 0.05) << i;
    EXPECT_LT(path.covariances[i].sigma_m(), 0.05) << "a room that is seen whole from everywhere";
    EXPECT_GE(path.covariances[i].tt, 0.0);
  }
  // The graph: places along the path, held together by steps from each to the next, by the front end and the wheels.
  ASSERT_GT(path.places.size(), 1U);
  EXPECT_EQ(path.places.front().scan, 0U);
  ASSERT_GE(path.path.size(), path.places.size() - 1);
  for (std::size_t k = 0; k < path.path.size(); ++k) {
    const PathRelation& step = path.path[k];
    const std::size_t place = k % (path.places.size() - 1);
    EXPECT_EQ(step.is_by_wheels, k >= path.places.size() - 1);
    EXPECT_EQ(step.from, path.places[place].scan);
    EXPECT_EQ(step.to, path.places[place + 1].scan);
    EXPECT_GT(step.information.xx * step.information.yy, step.information.xy * step.information.xy);
    const Pose2 actual = between(truth_[step.from], truth_[step.to]);
    // Places are 4 m apart, so wheels that miss a tenth of the way would be off by 0.4 m were they not corrected.
    EXPECT_LT((step.T_from_to.translation() - actual.translation()).norm(), step.is_by_wheels ? 0.2 : 0.1) << k;
  }
  EXPECT_GT(path.wheels.sigma_distance, 0.0);
  EXPECT_LT(path.rms_m, 0.02);
  EXPECT_GT(mapper.loops()->field().geometry().cell_count(), 0U);
}

// A graph of one place tells nothing; the steps between its keyframes do.
TEST_F(LoopsOfARoom, ADriveWithoutASecondPlaceHasCovariances) {
  Mapper mapper({}, *backend_, {.with_loops = true});
  const std::vector<test::Segment> walls = test::furnished_room();
  const std::vector<Pose2> truth = test::drive_through_room();
  double driven_m = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (i > 0) driven_m += translation_length(between(truth[i - 1], truth[i]));
    if (driven_m > 3.5) break;
    mapper.process(test::scan_of(walls, truth[i], 0.1 * static_cast<double>(i)), truth[i]);
  }
  const ClosedPath path = mapper.loops()->close([](std::string_view, double) {}, [] { return false; });
  ASSERT_EQ(path.places.size(), 1U);
  ASSERT_GT(path.keyframes.size(), 3U);
  for (const PoseCovariance& covariance : {path.covariances.front(), path.covariances.back()}) {
    EXPECT_GT(covariance.sigma_m(), 1.0e-4);
    EXPECT_LT(covariance.sigma_m(), 0.1);
    EXPECT_GT(covariance.tt, 1.0e-10);
  }
}

TEST_F(LoopsOfARoom, GivesTheSameBytesWithAndWithoutAThreadBeside) {
  std::vector<ClosedPath> paths;
  for (const bool is_beside : {true, false}) {
    MapperOptions options;
    options.with_loops = true;
    options.loops_beside = is_beside;
    Mapper mapper({}, *backend_, options);
    drive(mapper);
    EXPECT_EQ(mapper.loops()->correction(), Pose2{}) << "fewer than eight places";
    const FrozenMap map = mapper.loops()->request_map().get();
    EXPECT_EQ(map.keyframes, mapper.statistics().keyframes);
    paths.push_back(mapper.loops()->close([](std::string_view, double) {}, [] { return false; }));
  }
  EXPECT_EQ(paths.front().T_map_base, paths.back().T_map_base);
  EXPECT_EQ(paths.front().keyframes, paths.back().keyframes);
  EXPECT_EQ(paths.front().pairs, paths.back().pairs);
}

// An interrupt, before it begins or while it goes on: the path is that of the front end, and the map is there.
TEST_F(LoopsOfARoom, StoppedItLeavesThePathAsItWasDriven) {
  for (const int calls : {0, 1, 4}) {
    front_end_.clear();
    truth_.clear();
    Mapper mapper({}, *backend_, {.with_loops = true});
    drive(mapper);
    int asked = 0;
    const ClosedPath path = mapper.loops()->close([](std::string_view, double) {}, [&] { return asked++ >= calls; });
    EXPECT_FALSE(path.is_closed);
    EXPECT_TRUE(path.loops.empty());
    EXPECT_TRUE(path.places.empty());
    EXPECT_TRUE(path.path.empty());
    EXPECT_TRUE(path.covariances.empty());
    ASSERT_EQ(path.T_map_base.size(), front_end_.size());
    for (std::size_t i = 0; i < front_end_.size(); ++i) {
      EXPECT_LT((path.T_map_base[i].translation() - front_end_[i].translation()).norm(), 1.0e-9) << calls << ": " << i;
    }
    EXPECT_GT(mapper.loops()->field().geometry().cell_count(), 0U);
    EXPECT_EQ(asked, calls + 1) << "asked again after it had said so";
  }
}

}  // namespace
}  // namespace gdtslam
