// Graphs whose right poses are known: a drive around a block, more than once.
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "engine/mapping/graph/pose_graph.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kRound = 40;  // poses of one time around

/// Where the robot is after so many steps of a metre, on a square of 10 m.
Pose2 truth(std::size_t i) {
  const std::size_t side = i % kRound / 10;
  const double along = static_cast<double>(i % 10);
  const Pose2 corner = Pose2{} * (side > 0 ? Pose2{10.0, 0.0, 0.5 * kPi} : Pose2{}) *
                       (side > 1 ? Pose2{10.0, 0.0, 0.5 * kPi} : Pose2{}) *
                       (side > 2 ? Pose2{10.0, 0.0, 0.5 * kPi} : Pose2{});
  return corner * Pose2{along, 0.0, 0.0};
}

PoseRelation relation_of(std::size_t from, std::size_t to, const Tangent2& error, double information) {
  return {.from = from,
          .to = to,
          .T_from_to = between(truth(from), truth(to)) * exp_tangent(error),
          .information = Matrix3::diagonal(information, information, 20.0 * information)};
}

/// Driven by wheels that err by some centimetres and milliradians a step.
PoseGraph drive(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  PoseGraph graph;
  graph.poses.push_back(truth(0));
  for (std::size_t i = 1; i < count; ++i) {
    const Tangent2 error{random.normal(0.0, 0.02), random.normal(0.0, 0.02), random.normal(0.0, 0.004)};
    graph.path.push_back(relation_of(i - 1, i, error, 2500.0));
    graph.poses.push_back(graph.poses.back() * graph.path.back().T_from_to);
  }
  return graph;
}

double largest_error_m(const PoseGraph& graph) {
  double largest = 0.0;
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    largest = std::max(largest, (graph.poses[i].translation() - truth(i).translation()).norm());
  }
  return largest;
}

// Geman and McClure's cost of loops, plain squares of the path.
double robust_cost(const PoseGraph& graph) {
  double sum = 0.0;
  for (const PoseRelation& r : graph.path) sum += relation_chi2(r, graph.poses[r.from], graph.poses[r.to]);
  for (const Loop& loop : graph.loops) {
    const double chi2 = relation_chi2(loop.relation, graph.poses[loop.relation.from], graph.poses[loop.relation.to]);
    sum += chi2 / (1.0 + chi2 / PoseGraph::kScale);
  }
  return sum;
}

// Wheels and matches that contradict the poses by half turns, and each other, some of them known in one direction
// alone: whole steps of Gauss and Newton lead ever farther away from there, to 20,000 km in a log whose odometry was
// wrong.
TEST(PoseGraph, WhatContradictsItselfBecomesNoWorse) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    PoseGraph graph = drive(kRound, seed);
    Random random(100 + seed);
    const std::size_t steps = graph.path.size();
    for (std::size_t i = 0; i < 2 * steps; ++i) {
      PoseRelation relation = graph.path[i % steps];
      relation.T_from_to = {random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0), random.uniform(-kPi, kPi)};
      const double weak = std::pow(10.0, random.uniform(-4.0, 1.0));
      const double sure = std::pow(10.0, random.uniform(1.0, 5.0));
      relation.information =
          i % 2 == 0 ? Matrix3::diagonal(weak, sure, 10.0 * sure) : Matrix3::diagonal(sure, weak, sure);
      if (i < steps) {
        graph.path[i] = relation;
      } else {
        graph.path.push_back(relation);
      }
    }
    graph.loops.push_back({relation_of(0, 3, {}, 2500.0), 1.0});
    const double before = robust_cost(graph);
    graph.optimise(true);
    EXPECT_LE(robust_cost(graph), before) << seed;
  }
}

TEST(PoseGraph, WithoutLoopsThePathStaysAsItIs) {
  PoseGraph graph = drive(3 * kRound, 1);
  const std::vector<Pose2> before = graph.poses;
  graph.optimise(true);
  EXPECT_EQ(graph.poses, before);
}

TEST(PoseGraph, RightLoopsBringEveryRoundOntoTheFirst) {
  PoseGraph graph = drive(3 * kRound, 1);
  const double before_m = largest_error_m(graph);
  for (std::size_t i = kRound; i < 3 * kRound; i += 4) {
    graph.loops.push_back({relation_of(i - kRound, i, {}, 1.0e4)});
  }
  graph.optimise(true);
  EXPECT_GT(before_m, 0.5);
  EXPECT_LT(largest_error_m(graph), 0.25 * before_m);
  for (const Loop& loop : graph.loops) EXPECT_GT(loop.weight, 0.8);
}

// Half of the loops are wrong by a door or a quarter of a turn, some of them in the same way.
TEST(PoseGraph, WrongLoopsAreSwitchedOffAndRightOnesStay) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    PoseGraph graph = drive(4 * kRound, seed);
    PoseGraph right = graph;
    for (std::size_t i = kRound; i < 4 * kRound; i += 4) {
      graph.loops.push_back({relation_of(i - kRound, i, {}, 1.0e4)});
      right.loops.push_back(graph.loops.back());
      if (i % 8 != 0) continue;
      const Tangent2 wrong = i % 16 == 0 ? Tangent2{4.0, 0.0, 0.0} : Tangent2{0.0, 0.0, 0.5 * kPi};
      graph.loops.push_back({relation_of(i - kRound, i, wrong, 1.0e4)});
    }
    graph.optimise(true);
    right.optimise(true);
    for (const Loop& loop : graph.loops) {
      const PoseRelation& relation = loop.relation;
      const Pose2 off = between(between(truth(relation.from), truth(relation.to)), relation.T_from_to);
      EXPECT_EQ(loop.is_on(), off.translation().norm() + std::fabs(off.theta_rad) < 1e-9) << seed;
    }
    for (std::size_t i = 0; i < graph.poses.size(); ++i) {
      EXPECT_LT((graph.poses[i].translation() - right.poses[i].translation()).norm(), 0.01) << seed;
    }
  }
}

// The gradient of the sum of squares by central differences, and its curvature where the residuals are small.
TEST(PoseGraph, NormalEquationsAreTheDerivatives) {
  PoseGraph graph = drive(12, 4);
  graph.path[5].information =
      times_transposed(Matrix3{{3, 1, 0, 0, 2, 1, 1, 0, 5}}, Matrix3{{3, 1, 0, 0, 2, 1, 1, 0, 5}});
  graph.poses[6] = graph.poses[6] * Pose2{1e-4, -2e-4, 1e-4};
  std::vector<BlockSystem::Pair> pairs;
  for (const PoseRelation& relation : graph.path) pairs.emplace_back(relation.from, relation.to);
  BlockSystem system(graph.poses.size(), pairs);
  for (const PoseRelation& relation : graph.path) add_relation(relation, graph.poses, 2.0, system);
  const auto half_cost = [&](const std::vector<Pose2>& poses) {
    double sum = 0.0;
    for (const PoseRelation& relation : graph.path)
      sum += relation_chi2(relation, poses[relation.from], poses[relation.to]);
    return sum;  // half of twice
  };
  constexpr double kStep = 1e-6;
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      Tangent2 step{};
      step[k] = kStep;
      std::vector<Pose2> ahead = graph.poses;
      std::vector<Pose2> back = graph.poses;
      ahead[i] = ahead[i] * exp_tangent(step);
      step[k] = -kStep;
      back[i] = back[i] * exp_tangent(step);
      EXPECT_NEAR((half_cost(ahead) - half_cost(back)) / (2.0 * kStep), -system.right[i][k], 2e-3) << i << ' ' << k;
    }
  }
}

TEST(GraphCovariance, IsThatOfTheDenseInverse) {
  PoseGraph graph = drive(kRound + 8, 6);
  for (std::size_t i = kRound; i < kRound + 8; i += 3) graph.loops.push_back({relation_of(i - kRound, i, {}, 1.0e4)});
  graph.optimise(true);
  const std::size_t size = graph.poses.size();
  std::vector<BlockSystem::Pair> pairs;
  for (const PoseRelation& relation : graph.path) pairs.emplace_back(relation.from, relation.to);
  for (const Loop& loop : graph.loops) pairs.emplace_back(loop.relation.from, loop.relation.to);
  BlockSystem system(size, pairs);
  for (const PoseRelation& relation : graph.path) add_relation(relation, graph.poses, 1.0, system);
  for (const Loop& loop : graph.loops) add_relation(loop.relation, graph.poses, loop.weight, system);
  // Relative to the first pose: without its rows and columns.
  Eigen::MatrixXd information =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * size - 3), static_cast<Eigen::Index>(3 * size - 3));
  const auto put = [&](std::size_t row, std::size_t column, const Matrix3& block) {
    if (row == 0 || column == 0) return;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        information(static_cast<Eigen::Index>(3 * row - 3) + i, static_cast<Eigen::Index>(3 * column - 3) + j) =
            block(i, j);
      }
    }
  };
  for (std::size_t row = 0; row < size; ++row) {
    put(row, row, system.diagonal[row]);
    for (std::size_t nth = 0; nth < system.row_columns(row).size(); ++nth) {
      put(row, system.row_columns(row)[nth], system.block(row, nth));
      put(system.row_columns(row)[nth], row, transposed(system.block(row, nth)));
    }
  }
  const Eigen::MatrixXd covariance = information.inverse();
  const GraphCovariance found(graph);
  for (const std::size_t to : {std::size_t{5}, kRound, size - 1}) {
    const Matrix3 relative = found.relative(0, to);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const auto at = static_cast<Eigen::Index>(3 * to - 3);
        EXPECT_NEAR(relative(i, j), covariance(at + i, at + j), 1e-6) << to;
      }
    }
  }
  // Of neighbours: no more than that of their own measurement.
  const Matrix3 neighbours = found.relative(20, 21);
  EXPECT_LE(neighbours(0, 0), 1.0 / 2500.0 + 1e-9);
  EXPECT_GT(neighbours(0, 0), 0.5 / 2500.0);
}

// Three times around, with relations between all that are side by side: solved by its own factor, and by that of the
// path and every fifth of them.
TEST(PoseGraph, ByACoreOfItsRelationsAStepIsTheSame) {
  const PoseGraph graph = drive(3 * kRound, 12);
  std::vector<PoseRelation> relations = graph.path;
  Random random(13);
  for (std::size_t i = kRound; i < graph.poses.size(); ++i) {
    for (std::size_t j = i % kRound; j < i; j += kRound) {
      relations.push_back(relation_of(j, i, {random.normal(0.0, 0.01), random.normal(0.0, 0.01), 0.0}, 10000.0));
    }
  }
  const auto system_with = [&](std::size_t every) {
    std::vector<BlockSystem::Pair> pattern;
    for (const PoseRelation& r : relations) pattern.emplace_back(r.from, r.to);
    BlockSystem system(graph.poses.size(), pattern);
    for (std::size_t k = 0; k < relations.size(); ++k) {
      if (k < graph.path.size() || k % every == 0) add_relation(relations[k], graph.poses, 1.0, system);
    }
    return system;
  };
  BlockSystem whole = system_with(1);
  BlockSystem again = whole;
  BlockSystem core = system_with(5);
  BlockCholesky factor(whole);
  BlockCholesky factor_of_core(core);
  std::vector<Pose2> direct = graph.poses;
  std::vector<Pose2> by_core = graph.poses;
  whole.diagonal.front() += Matrix3::diagonal(1.0e12, 1.0e12, 1.0e12);
  ASSERT_TRUE(factor.factorise(whole));
  std::vector<Tangent2> steps = whole.right;
  factor.solve(steps);
  double moved_m = 0.0;
  for (std::size_t i = 0; i < direct.size(); ++i) {
    direct[i] = direct[i] * exp_tangent(steps[i]);
    moved_m = std::max(moved_m, std::hypot(steps[i][0], steps[i][1]));
  }
  EXPECT_GT(moved_m, 0.05);
  ASSERT_TRUE(factorise_core(core, factor_of_core));
  EXPECT_NEAR(take_step_by_core(again, factor_of_core, by_core), moved_m, 1.0e-3 * moved_m);
  for (std::size_t i = 0; i < direct.size(); ++i) {
    EXPECT_LT((direct[i].translation() - by_core[i].translation()).norm(), 1.0e-3 * moved_m) << i;
  }
}

}  // namespace
}  // namespace gdtslam
