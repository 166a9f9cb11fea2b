#include "gdtslam/core/nodding.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "elementary.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kTurn = 4294967296.0;  // 2^32
constexpr std::uint32_t kMostBits = 20;

Eigen::Quaterniond rotation_about(const Eigen::Vector3d& axis, double angle_rad) { return exp_so3(axis * angle_rad); }

// The k of 2^k + 1 values; more than kMostBits if there is none.
std::uint32_t index_bits(std::size_t count) {
  std::uint32_t bits = 0;
  while (bits <= kMostBits && (std::size_t{1} << bits) + 1 != count) ++bits;
  return bits;
}

}  // namespace

LevelTurn::LevelTurn(const NoddingMount& mount) : lever_m_(mount.lever_forward_m, 0.0, mount.lever_up_m) {
  const Eigen::Quaterniond yaw = rotation_about(Eigen::Vector3d::UnitZ(), mount.sensor_yaw_rad);
  const Eigen::Quaterniond roll = rotation_about(Eigen::Vector3d::UnitX(), mount.sensor_roll_rad);
  T_axis_laser_ =
      Pose3{lever_m_, Eigen::Quaterniond::Identity()} * Pose3{Point3::Zero(), yaw} * Pose3{Point3::Zero(), roll};
}

Pose3 LevelTurn::T_level_laser(double elevation_rad) const {
  return Pose3{-lever_m_, rotation_about(Eigen::Vector3d::UnitY(), -elevation_rad)} * T_axis_laser_;
}

Pose3 T_level_laser(const NoddingMount& mount, double elevation_rad) {
  return LevelTurn(mount).T_level_laser(elevation_rad);
}

Pose3 T_base_laser(const NoddingMount& mount, const Pose2& T_base_level, double elevation_rad) {
  return embed(T_base_level, mount.height_m) * T_level_laser(mount, elevation_rad);
}

Phase phase_of_turns(double turns) {
  const double share = turns - std::floor(turns);
  return static_cast<Phase>(static_cast<std::uint64_t>(std::floor(share * kTurn + 0.5)));
}

double turns_of_phase(Phase phase) { return static_cast<double>(phase) / kTurn; }

ElevationTable::ElevationTable(std::vector<double> elevations_rad)
    : bits_(index_bits(elevations_rad.size())), values_rad_(std::move(elevations_rad)) {
  if (bits_ > kMostBits) {
    throw ConfigError("an elevation table has 2^k + 1 values, k from 0 to 20, not " +
                      std::to_string(values_rad_.size()));
  }
  for (const double value : values_rad_) {
    if (!(std::fabs(value) <= kTwoPi)) throw ConfigError("an elevation of the table is not finite or beyond 2 pi");
  }
}

ElevationTable ElevationTable::identity() { return ElevationTable({-kPi, kPi}); }

double ElevationTable::elevation_rad(Phase phase) const {
  const double position = turns_of_phase(phase) * static_cast<double>(std::size_t{1} << bits_);
  const auto index = static_cast<std::size_t>(position);
  const double low = values_rad_[index];
  return low + (values_rad_[index + 1] - low) * (position - static_cast<double>(index));
}

Phase phase_of_elevation(double elevation_rad) { return phase_of_turns((elevation_rad + kPi) / kTwoPi); }

}  // namespace gdtslam
