// Covariances without a pose held, against the dense algebra of the definition and against simulated errors.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

// A round of a square with unequal steps, closed by two loops.
PoseGraph square_round(std::size_t nodes) {
  PoseGraph graph;
  Pose2 T{3.0, -2.0, 0.4};
  for (std::size_t i = 0; i < nodes; ++i) {
    graph.poses.push_back(T);
    const bool turns = i % (nodes / 4) == nodes / 4 - 1;
    T = T * Pose2{1.0 + 0.05 * static_cast<double>(i % 3), 0.0, turns ? 0.5 * kPi : 0.0};
  }
  const auto relate = [&graph](std::size_t from, std::size_t to, const Matrix3& information) {
    return PoseRelation{from, to, between(graph.poses[from], graph.poses[to]), information};
  };
  for (std::size_t i = 1; i < nodes; ++i) {
    graph.path.push_back(relate(i - 1, i, Matrix3::diagonal(900.0, 2500.0, 40000.0 / static_cast<double>(1 + i % 4))));
  }
  graph.loops.push_back({relate(0, nodes - 1, Matrix3::diagonal(400.0, 400.0, 2500.0)), 1.0});
  graph.loops.push_back({relate(2, nodes / 2, Matrix3::diagonal(4.0, 100.0, 2500.0)), 0.5});
  return graph;
}

std::vector<std::size_t> all_of(const PoseGraph& graph) {
  std::vector<std::size_t> nodes(graph.poses.size());
  std::iota(nodes.begin(), nodes.end(), std::size_t{0});
  return nodes;
}

// The pseudo-inverse of the whole normal matrix, no pose held, in map axes, with the best rigid motion of the
// positions projected out of it.
std::vector<Eigen::Matrix3d> dense_covariances(const PoseGraph& graph) {
  const auto n = static_cast<Eigen::Index>(graph.poses.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  const auto add = [&](const PoseRelation& relation, double weight) {
    const auto from = static_cast<Eigen::Index>(relation.from);
    const auto to = static_cast<Eigen::Index>(relation.to);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, 3 * n);
    J.block<3, 3>(0, 3 * to).setIdentity();
    J.block<3, 3>(0, 3 * from) = -adjoint(between(graph.poses[relation.to], graph.poses[relation.from]));
    Eigen::Matrix3d information;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) information(r, c) = weight * relation.information(r, c);
    }
    normal += J.transpose() * information * J;
  };
  for (const PoseRelation& relation : graph.path) add(relation, 1.0);
  for (const Loop& loop : graph.loops) add(loop.relation, loop.weight);
  Eigen::MatrixXd to_map = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  Eigen::MatrixXd motion(3 * n, 3);     // of every pose by a rigid motion about the origin
  Eigen::MatrixXd positions(2 * n, 3);  // of the positions alone
  Eigen::MatrixXd pick = Eigen::MatrixXd::Zero(2 * n, 3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Pose2& T = graph.poses[static_cast<std::size_t>(i)];
    to_map.block<2, 2>(3 * i, 3 * i) = Eigen::Rotation2Dd(T.theta_rad).toRotationMatrix();
    to_map(3 * i + 2, 3 * i + 2) = 1.0;
    motion.block<3, 3>(3 * i, 0) << 1.0, 0.0, -T.y_m, 0.0, 1.0, T.x_m, 0.0, 0.0, 1.0;
    pick.block<2, 2>(2 * i, 3 * i).setIdentity();
  }
  positions = pick * motion;
  const Eigen::MatrixXd inverse = normal.completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::MatrixXd best = positions.completeOrthogonalDecomposition().pseudoInverse() * pick;
  const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(3 * n, 3 * n) - motion * best;
  const Eigen::MatrixXd covariance = rest * to_map * inverse * to_map.transpose() * rest.transpose();
  std::vector<Eigen::Matrix3d> blocks;
  for (Eigen::Index i = 0; i < n; ++i) blocks.emplace_back(covariance.block<3, 3>(3 * i, 3 * i));
  return blocks;
}

TEST(FreeNetwork, IsWhatDenseAlgebraGives) {
  const PoseGraph graph = square_round(24);
  const std::vector<Eigen::Matrix3d> expected = dense_covariances(graph);
  const std::vector<Matrix3> covariances = covariances_in_map(graph, all_of(graph));
  ASSERT_EQ(covariances.size(), expected.size());
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(covariances[i](r, c), expected[i](r, c), 1.0e-6 * expected[i].norm())
            << i << ": " << r << ", " << c;
      }
    }
  }
}

// Wherever the graph lies and whichever pose it was held at.
TEST(FreeNetwork, DoesNotKnowWhereTheMapLies) {
  const PoseGraph graph = square_round(16);
  PoseGraph moved = graph;
  const Pose2 T{40.0, -15.0, 2.0};
  for (Pose2& pose : moved.poses) pose = T * pose;
  const std::vector<Matrix3> here = covariances_in_map(graph, all_of(graph));
  const std::vector<Matrix3> there = covariances_in_map(moved, all_of(moved));
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_NEAR(position_sigma(there[i]), position_sigma(here[i]), 1.0e-6);
    EXPECT_NEAR(there[i](2, 2), here[i](2, 2), 1.0e-9);
  }
}

// A chain of a thousand drives, each laid over the truth: how far its poses are off at the root of the mean square.
TEST(FreeNetwork, IsHowFarSimulatedDrivesAreOff) {
  constexpr std::size_t kNodes = 20;
  constexpr int kDrives = 4000;
  PoseGraph graph;
  graph.poses.emplace_back();
  const Pose2 step{1.0, 0.0, 0.1};
  const double sigma_m = 0.01;
  const double sigma_rad = 0.002;
  for (std::size_t i = 1; i < kNodes; ++i) {
    graph.poses.push_back(graph.poses.back() * step);
    graph.path.push_back(
        {i - 1, i, step,
         Matrix3::diagonal(1.0 / (sigma_m * sigma_m), 1.0 / (sigma_m * sigma_m), 1.0 / (sigma_rad * sigma_rad))});
  }
  Random random(7);
  std::vector<double> squares(kNodes, 0.0);
  for (int drive = 0; drive < kDrives; ++drive) {
    Eigen::Matrix2Xd driven(2, kNodes);
    Eigen::Matrix2Xd truth(2, kNodes);
    Pose2 T;
    for (std::size_t i = 0; i < kNodes; ++i) {
      if (i > 0) {
        T = T * step * Pose2{random.normal(0.0, sigma_m), random.normal(0.0, sigma_m), random.normal(0.0, sigma_rad)};
      }
      driven.col(static_cast<Eigen::Index>(i)) = T.translation();
      truth.col(static_cast<Eigen::Index>(i)) = graph.poses[i].translation();
    }
    const Eigen::Matrix3d laid = Eigen::umeyama(driven, truth, false);
    for (std::size_t i = 0; i < kNodes; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const Eigen::Vector2d off = (laid * driven.col(column).homogeneous()).head<2>() - truth.col(column);
      squares[i] += off.squaredNorm() / kDrives;
    }
  }
  const std::vector<Matrix3> covariances = covariances_in_map(graph, all_of(graph));
  for (std::size_t i = 0; i < kNodes; ++i) {
    EXPECT_NEAR(std::sqrt(covariances[i](0, 0) + covariances[i](1, 1)), std::sqrt(squares[i]),
                0.06 * std::sqrt(squares[i]))
        << i;
  }
}

TEST(SpreadCovariances, AreLinearBetweenThoseKnownAndConstantBehind) {
  const std::vector<std::size_t> at{0, 4};
  const std::vector<Matrix3> known{Matrix3::diagonal(1.0, 2.0, 3.0), Matrix3::diagonal(5.0, 2.0, 1.0)};
  const std::vector<Matrix3> all = spread_covariances(at, known, 7);
  ASSERT_EQ(all.size(), 7U);
  EXPECT_EQ(all[0], known[0]);
  EXPECT_EQ(all[1], Matrix3::diagonal(2.0, 2.0, 2.5));
  EXPECT_EQ(all[6], known[1]);
}

}  // namespace
}  // namespace gdtslam
