#include "gdtslam/sim/wheel_model.hpp"

#include <cmath>

namespace gdtslam::sim {

std::vector<std::string> validate(const WheelModel& wheels) {
  std::vector<std::string> faults;
  // Written so that a value that is not a number counts as outside.
  const auto require = [&faults](double value, double low, double high, const char* fault) {
    if (!(value >= low && value <= high)) {
      faults.emplace_back(fault);
    }
  };
  require(wheels.drive.track_width_m, 0.01, 100.0, "track_width must be 1 cm to 100 m");
  require(wheels.drive.centre_ahead_of_axle_m, -100.0, 100.0, "centre_ahead_of_axle must be -100 to 100 m");
  require(wheels.track_width_scale, 0.5, 2.0, "track_width_scale must be 0.5 to 2");
  require(wheels.left_scale, 0.5, 2.0, "left_scale must be 0.5 to 2");
  require(wheels.right_scale, 0.5, 2.0, "right_scale must be 0.5 to 2");
  require(wheels.slip_m_per_sqrt_m, 0.0, 10.0, "slip must be 0 to 10 m after 1 m");
  require(wheels.ticks_per_m, 1.0, 1e9, "ticks_per_metre must be 1 to 1e9");
  return faults;
}

WheelEncoders::WheelEncoders(const WheelModel& wheels, const Random& random)
    : wheels_(wheels), left_random_(random.split(0)), right_random_(random.split(1)) {}

void WheelEncoders::advance(double left_m, double right_m) {
  left_m_ += seen(left_m, wheels_.left_scale, left_random_);
  right_m_ += seen(right_m, wheels_.right_scale, right_random_);
}

double WheelEncoders::seen(double travel_m, double scale, Random& random) const {
  return scale * travel_m + wheels_.slip_m_per_sqrt_m * std::sqrt(std::fabs(travel_m)) * random.normal();
}

WheelTicks WheelEncoders::ticks() const {
  return {static_cast<std::int64_t>(std::floor(left_m_ * wheels_.ticks_per_m)),
          static_cast<std::int64_t>(std::floor(right_m_ * wheels_.ticks_per_m))};
}

Pose2 WheelOdometer::update(const WheelTicks& ticks) {
  const double left_m = static_cast<double>(ticks.left - last_.left) / wheels_.ticks_per_m;
  const double right_m = static_cast<double>(ticks.right - last_.right) / wheels_.ticks_per_m;
  last_ = ticks;
  T_odom_base_ = T_odom_base_ * wheel_displacement(wheels_.drive, left_m, right_m);
  return T_odom_base_;
}

}  // namespace gdtslam::sim
