// What a loop is told by walls that the group's middle did not see itself.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "engine/mapping/loops/scan_group.hpp"

namespace gdtslam {
namespace {

Matrix3 shape_of_wall(const Point2& normal, const Point2& at) {
  const double lever = at.x() * normal.y() - at.y() * normal.x();
  const Tangent2 J{normal.x(), normal.y(), lever};
  return outer(J, J);
}

/// Five keyframes a metre apart along x, seen from the third.
std::vector<Pose2> straight_group() {
  std::vector<Pose2> poses;
  for (int i = -2; i <= 2; ++i) poses.push_back({static_cast<double>(i), 0.0, 0.0});
  return poses;
}

Matrix3 walls_beside(double x_m) { return 50.0 * shape_of_wall({0.0, 1.0}, {x_m, 2.0}); }

// Two steps of 3 cm along the way, and 10 cm by which the middle may lie elsewhere along what it does not see.
TEST(GroupDoubt, AWallAheadIsAsSureAsTheWayThere) {
  const StepDoubt step{Matrix3::diagonal(9.0e-4, 1.0e-10, 1.0e-12), {}};
  std::vector<StepDoubt> doubts(5, step);
  doubts[2].unseen = Matrix3::diagonal(0.01, 0.0, 0.0);
  std::vector<Matrix3> shapes;
  for (int i = -2; i <= 2; ++i) shapes.push_back(walls_beside(i));
  shapes[4] += 20.0 * shape_of_wall({-1.0, 0.0}, {6.0, 0.0});
  const Matrix3 covariance = GroupDoubt(doubts, straight_group(), 2).of_pose(shapes);
  EXPECT_NEAR(covariance(0, 0), 2.0 * 9.0e-4 + 0.01, 1.0e-6);
  EXPECT_NEAR(covariance(1, 1), 0.0, 1.0e-6);
}

TEST(GroupDoubt, OfWhatTheMiddleSawThereIsNone) {
  const StepDoubt step{Matrix3::diagonal(9.0e-4, 9.0e-4, 1.0e-4), Matrix3::diagonal(1.0, 1.0, 0.0)};
  const std::vector<StepDoubt> doubts(5, step);
  std::vector<Matrix3> shapes(5);
  shapes[2] = walls_beside(-3.0) + walls_beside(3.0) + 20.0 * shape_of_wall({-1.0, 0.0}, {6.0, 0.0});
  const Matrix3 covariance = GroupDoubt(doubts, straight_group(), 2).of_pose(shapes);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(covariance(i, i), 0.0, 1.0e-12);
  EXPECT_NEAR(GroupDoubt({}, straight_group(), 2).of_pose(shapes)(0, 0), 0.0, 1.0e-12) << "keyframes that lie exactly";
}

// Beside steps that are drawn at random: how far the least squares pose goes, a hundred thousand times.
TEST(GroupDoubt, IsWhatDrawnStepsCauseOnACurve) {
  std::vector<Pose2> poses;
  for (int i = -2; i <= 2; ++i) {
    const double turn = 0.3 * i;
    poses.push_back({3.0 * std::sin(turn), 3.0 - 3.0 * std::cos(turn), turn});
  }
  const StepDoubt step{Matrix3::diagonal(4.0e-4, 1.0e-4, 2.5e-5), {}};
  const std::vector<Matrix3> shapes{30.0 * shape_of_wall({1.0, 0.0}, {-4.0, 1.0}), walls_beside(-2.0),
                                    walls_beside(1.0), 20.0 * shape_of_wall({-0.6, 0.8}, {2.0, -1.0}),
                                    10.0 * shape_of_wall({-1.0, 0.0}, {5.0, 3.0})};
  const Matrix3 stated = GroupDoubt(std::vector<StepDoubt>(5, step), poses, 2).of_pose(shapes);

  Matrix3 whole;
  for (const Matrix3& shape : shapes) whole += shape;
  const Matrix3 pose_by_pull = inverse(whole);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto drawn = [&](std::size_t keyframe) {
    const Tangent2 off{0.02 * normal(random), 0.01 * normal(random), 0.005 * normal(random)};
    return adjoint_matrix(poses[keyframe]) * off;
  };
  Matrix3 seen;
  constexpr int kDraws = 100'000;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<Tangent2> moved(5);
    moved[3] = drawn(3);
    moved[4] = moved[3];
    add(moved[4], drawn(4));
    moved[1] = drawn(2);  // the step into the middle moves what is before it
    moved[0] = moved[1];
    add(moved[0], drawn(1));
    Tangent2 pull{};
    for (std::size_t i = 0; i < 5; ++i) add(pull, shapes[i] * moved[i]);
    const Tangent2 pose = pose_by_pull * pull;
    seen += outer(pose, pose);
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const double scale = std::sqrt(stated(row, row) * stated(column, column));
      EXPECT_NEAR(seen(row, column) / kDraws, stated(row, column), 0.02 * scale) << row << " " << column;
    }
  }
}

}  // namespace
}  // namespace gdtslam
