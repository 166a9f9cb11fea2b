#include "levelling.hpp"

#include <cmath>

#include "engine/mapping/graph/matrix3.hpp"

namespace gdtslam {
namespace {

constexpr int kIterations = 10;
constexpr double kRobot_rad = 0.005;  // standard deviation of the robot's mean tilt
constexpr double kSurfel_rad = 0.01;  // and of a surfel's normal
constexpr double kSteep_rad = 0.15;   // those of surfaces further from upright or level do not count
constexpr double kAlike = 100.0;      // surfels that say the same count as one
constexpr double kFlat = 0.95;        // least upward part of a floor's normal
constexpr double kNearFloor_m = 0.1;
constexpr double kFloorNoise_m = 0.02;

/// Normal equations of a turn about x and y.
class TurnEquations {
 public:
  explicit TurnEquations(const std::array<double, 2>& turn_rad) : turn_(turn_rad) {}
  /// `off` is to become 0, and changes by these with the turn.
  void add(double off, double by_x, double by_y) {
    const double now = off + by_x * turn_[0] + by_y * turn_[1];
    if (std::fabs(now) > kSteep_rad) return;
    const double sq = square(kSurfel_rad);
    add_weighted(sq / square(sq + now * now) / kAlike, now, by_x, by_y);  // Geman and McClure's weight
  }
  void add_weighted(double weight, double now, double by_x, double by_y) {
    xx_ += weight * by_x * by_x;
    xy_ += weight * by_x * by_y;
    yy_ += weight * by_y * by_y;
    x_ -= weight * by_x * now;
    y_ -= weight * by_y * now;
  }
  [[nodiscard]] std::array<double, 2> solved() const {
    const double det = xx_ * yy_ - xy_ * xy_;
    return {turn_[0] + (yy_ * x_ - xy_ * y_) / det, turn_[1] + (xx_ * y_ - xy_ * x_) / det};
  }

 private:
  std::array<double, 2> turn_;
  double xx_ = 0.0, xy_ = 0.0, yy_ = 0.0, x_ = 0.0, y_ = 0.0;
};

}  // namespace

std::array<double, 2> find_levelling_turn(std::span<const Surfel> surfels, const std::array<double, 2>& robot_rad) {
  std::array<double, 2> turn = robot_rad;
  for (int k = 0; k < kIterations; ++k) {
    TurnEquations sums(turn);
    const double weight = 1.0 / square(kRobot_rad);
    sums.add_weighted(weight, turn[0] - robot_rad[0], 1.0, 0.0);
    sums.add_weighted(weight, turn[1] - robot_rad[1], 0.0, 1.0);
    for (const Surfel& surfel : surfels) {
      const Point3& n = surfel.normal;
      if (std::fabs(n.z()) < 0.5) {
        sums.add(n.z(), n.y(), -n.x());
      } else {
        sums.add(n.x(), 0.0, n.z());
        sums.add(n.y(), -n.z(), 0.0);
      }
    }
    turn = sums.solved();
  }
  return turn;
}

double find_floor_height(std::span<const Surfel> surfels, double near_m) {
  double height_m = near_m;
  for (int k = 0; k < kIterations; ++k) {
    double sum = 0.0;
    double weights = 0.0;
    for (const Surfel& surfel : surfels) {
      if (surfel.normal.z() < kFlat || std::fabs(surfel.mean.z() - near_m) > kNearFloor_m) continue;
      const double weight = 1.0 / square(square(kFloorNoise_m) + square(surfel.mean.z() - height_m));
      sum += weight * surfel.mean.z();
      weights += weight;
    }
    if (weights > 0.0) height_m = sum / weights;
  }
  return height_m;
}

}  // namespace gdtslam
