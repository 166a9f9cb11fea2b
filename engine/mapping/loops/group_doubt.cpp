#include "group_doubt.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastPull = 1.0e-9;  // share of all points' pull below which a direction counts as unseen

Matrix3 carried(const Matrix3& covariance, const Pose2& T) {
  const Matrix3 adjoint = adjoint_matrix(T);
  return adjoint * times_transposed(covariance, adjoint);
}

Matrix3 propagated(const Matrix3& gain, const Matrix3& covariance) { return gain * times_transposed(covariance, gain); }

}  // namespace

GroupDoubt::GroupDoubt(std::span<const StepDoubt> doubts, std::span<const Pose2> in_middle, std::size_t middle)
    : middle_(middle) {
  for (std::size_t i = 0; i < doubts.size(); ++i) {
    steps_.push_back(carried(doubts[i].step, in_middle[i]));
    unseen_.push_back(carried(doubts[i].unseen, in_middle[i]));
  }
}

Matrix3 GroupDoubt::of_pose(std::span<const Matrix3> shapes) const {
  Matrix3 sum;
  if (unseen_.empty()) return sum;
  Matrix3 whole;
  for (const Matrix3& shape : shapes) whole += shape;
  const double least = kLeastPull * (whole(0, 0) + whole(1, 1) + whole(2, 2) + 1.0);
  const Matrix3 pose_by_pull = inverse(whole + Matrix3::diagonal(least, least, least));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (i != middle_) sum += propagated(pose_by_pull * shapes[i], unseen_[i]);
  }
  Matrix3 elsewhere = whole;
  elsewhere -= shapes[middle_];
  sum += propagated(pose_by_pull * elsewhere, unseen_[middle_]);
  Matrix3 behind;
  for (std::size_t i = shapes.size() - 1; i > middle_; --i) {
    behind += shapes[i];
    sum += propagated(pose_by_pull * behind, steps_[i]);
  }
  Matrix3 before;
  for (std::size_t i = 0; i < middle_; ++i) {
    before += shapes[i];
    sum += propagated(pose_by_pull * before, steps_[i + 1]);
  }
  return sum;
}

}  // namespace gdtslam
