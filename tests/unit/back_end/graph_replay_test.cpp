// A graph as it grew: its stages against a solution of the whole by another way, and against the growth of noise.
#include "engine/mapping/graph/graph_replay.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <cmath>
#include <cstddef>
#include <vector>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr double kStep_m = 4.0;

/// Round a square of 5 places a side; the last place is the first again.
Pose2 place_of_square(std::size_t i) {
  Pose2 pose;
  for (std::size_t k = 0; k < i; ++k) pose = pose * Pose2{kStep_m, 0.0, k % 5 == 4 ? 0.5 * kPi : 0.0};
  return pose;
}

/// Each step measured twice, with different noise, and loops between places that lie at the same spot.
PoseGraph square_drive(std::size_t places) {
  Random random(7);
  const auto measured = [&random](std::size_t from, std::size_t to, double deviation_m) {
    const Tangent2 error{random.normal(0.0, deviation_m), random.normal(0.0, deviation_m),
                         random.normal(0.0, 0.1 * deviation_m)};
    const double information = 1.0 / (deviation_m * deviation_m);
    return PoseRelation{.from = from,
                        .to = to,
                        .T_from_to = between(place_of_square(from), place_of_square(to)) * exp_tangent(error),
                        .information = Matrix3::diagonal(information, information, 100.0 * information)};
  };
  PoseGraph graph;
  graph.poses.resize(places);
  for (std::size_t i = 0; i + 1 < places; ++i) graph.path.push_back(measured(i, i + 1, 0.02));
  for (std::size_t i = 0; i + 1 < places; ++i) graph.path.push_back(measured(i, i + 1, 0.04));
  for (std::size_t i = 20; i < places; i += 3) graph.loops.push_back({measured(i - 20, i, 0.003), 0.5});
  return graph;
}

/// The sum of what the relations say against these poses, each loop times its weight.
double chi2_of_graph(const PoseGraph& graph, const std::vector<Pose2>& poses) {
  double sum = 0.0;
  for (const PoseRelation& relation : graph.path)
    sum += relation_chi2(relation, poses[relation.from], poses[relation.to]);
  for (const Loop& loop : graph.loops) {
    sum += loop.weight * relation_chi2(loop.relation, poses[loop.relation.from], poses[loop.relation.to]);
  }
  return sum;
}

TEST(GraphReplay, BeginsWithThePathAsTheFirstMeasuredIt) {
  const PoseGraph graph = square_drive(30);
  const std::vector<ReplayStage> stages = replay_graph(graph, 100);
  ASSERT_FALSE(stages.empty());
  EXPECT_TRUE(stages[0].loops.empty());
  Pose2 pose;
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_NEAR((stages[0].poses[i].translation() - pose.translation()).norm(), 0.0, 1e-9) << i;
    if (i + 1 < 30) pose = pose * graph.path[i].T_from_to;
  }
}

TEST(GraphReplay, EveryLoopComesOnceAtItsLaterPlace) {
  const PoseGraph graph = square_drive(40);
  for (const std::size_t most : {1U, 2U, 3U, 100U}) {
    const std::vector<ReplayStage> stages = replay_graph(graph, most);
    EXPECT_LE(stages.size(), most + 1);
    std::vector<int> times(graph.loops.size(), 0);
    for (std::size_t k = 1; k < stages.size(); ++k) {
      EXPECT_GT(stages[k].place, stages[k - 1].place);
      for (const std::size_t loop : stages[k].loops) {
        ++times[loop];
        EXPECT_LE(graph.loops[loop].relation.to, stages[k].place);
        EXPECT_GT(graph.loops[loop].relation.to, stages[k - 1].place);
      }
    }
    for (const int count : times) EXPECT_EQ(count, 1);
  }
}

// No pose moved a little in any direction makes what was driven so far fit better.
TEST(GraphReplay, EachStageIsTheLeastOfWhatIsKnownThen) {
  const PoseGraph graph = square_drive(33);
  for (const ReplayStage& stage : replay_graph(graph, 3)) {
    if (stage.loops.empty()) continue;
    PoseGraph part = graph;
    const auto is_later = [&](const PoseRelation& relation) { return relation.to > stage.place; };
    std::erase_if(part.path, is_later);
    std::erase_if(part.loops, [&](const Loop& loop) { return is_later(loop.relation); });
    const double least = chi2_of_graph(part, stage.poses);
    for (std::size_t i = 1; i <= stage.place; ++i) {
      for (const Pose2& nudge : {Pose2{1e-4, 0, 0}, Pose2{-1e-4, 0, 0}, Pose2{0, 1e-4, 0}, Pose2{0, -1e-4, 0},
                                 Pose2{0, 0, 1e-5}, Pose2{0, 0, -1e-5}}) {
        std::vector<Pose2> moved = stage.poses;
        moved[i] = moved[i] * nudge;
        EXPECT_GT(chi2_of_graph(part, moved), least) << "place " << i << " at stage of place " << stage.place;
      }
    }
    for (std::size_t i = stage.place; i + 1 < stage.poses.size(); ++i) {
      const Pose2 step = between(stage.poses[i], stage.poses[i + 1]);
      EXPECT_NEAR((step.translation() - graph.path[i].T_from_to.translation()).norm(), 0.0, 1e-9);
    }
  }
}

/// The covariance of a place with the first one held, by inverting the whole system densely.
Eigen::Matrix3d dense_covariance(const PoseGraph& graph, const std::vector<Pose2>& poses, std::size_t place) {
  const auto size = static_cast<Eigen::Index>(3 * (place + 1));
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(size, size);
  const auto add_block = [&](const PoseRelation& relation, double weight) {
    if (relation.to > place) return;
    Eigen::Matrix3d information;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) information(r, c) = weight * relation.information(r, c);
    }
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3, size);
    jacobian.middleCols<3>(static_cast<Eigen::Index>(3 * relation.to)) = Eigen::Matrix3d::Identity();
    jacobian.middleCols<3>(static_cast<Eigen::Index>(3 * relation.from)) =
        -adjoint(between(poses[relation.to], poses[relation.from]));
    system += jacobian.transpose() * information * jacobian;
  };
  for (const PoseRelation& relation : graph.path) add_block(relation, 1.0);
  for (const Loop& loop : graph.loops) add_block(loop.relation, loop.weight);
  const Eigen::MatrixXd free = system.bottomRightCorner(size - 3, size - 3);
  return free.inverse().bottomRightCorner<3, 3>();
}

TEST(GraphReplay, TheRobotIsAsSureAsThePathAndTheLoopsSoFarMakeIt) {
  const PoseGraph graph = square_drive(26);
  const std::vector<ReplayStage> stages = replay_graph(graph, 100);
  for (std::size_t k = 0; k < stages.size(); ++k) {
    const ReplayStage& stage = stages[k];
    PoseGraph known = graph;
    std::erase_if(known.loops, [&](const Loop& loop) { return loop.relation.to > stage.place; });
    for (std::size_t i = 0; i < stage.covariances.size(); ++i) {
      if (stage.place + i == 0) continue;
      const Eigen::Matrix3d truth = dense_covariance(known, stage.poses, stage.place + i);
      for (int r = 0; r < 3; ++r) {
        // From the last solution on steps are taken as they were measured, which the others do not quite agree with.
        EXPECT_NEAR(stage.covariances[i](r, r), truth(r, r), 1e-3 * truth(r, r))
            << "stage " << k << ", " << i << " places on, " << r;
      }
    }
  }
  EXPECT_LT(stages[1].covariances.front()(0, 0), stages[0].covariances.back()(0, 0)) << "a loop makes it surer";
}

TEST(GraphReplay, AGraphOfOnePlaceStandsStill) {
  PoseGraph graph;
  EXPECT_TRUE(replay_graph(graph, 10).empty());
  graph.poses = {{1.0, 2.0, 0.5}};
  const std::vector<ReplayStage> stages = replay_graph(graph, 10);
  ASSERT_EQ(stages.size(), 1U);
  EXPECT_EQ(stages[0].poses, graph.poses);
}

}  // namespace
}  // namespace gdtslam
