// The pose of one cloud in another, from a start that may be a metre and 30 degrees off: by normal distributions from
// coarse cubes to fine ones [Magnusson2009], then by points and planes [ChenMedioni1992]. Made for rooms and buildings:
// the cubes are 2 m to 25 cm. The same on every machine. Cost: a tenth of a second for clouds of 40,000 points.
#pragma once

#include <cstdint>
#include <span>

#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

enum class AlignmentMethod : std::uint8_t { kNdt, kPlane, kBoth };

struct AlignmentOptions {
  AlignmentMethod method = AlignmentMethod::kBoth;
  bool is_planar = false;  ///< only x, y and yaw are looked for
  Pose3 T_a_b{};           ///< start
};

/// How two clouds lie on each other.
struct CloudFit {
  double overlap = 0.0;   ///< share of b's points that have one of a within 30 cm
  double median_m = 0.0;  ///< of these points' distances from a's planes
};

struct Alignment {
  Pose3 T_a_b;
  CloudFit before;  ///< at the start
  CloudFit after;
  /// Standard deviations of the position and of the turns about a's axes, by the noise of the points alone.
  Tangent3 sigma = Tangent3::Zero();
  /// The direction that the planes hold least, and the ratio of what they hold there to the most: near 0 it is free.
  /// Turns are counted at the mean distance of the points.
  Tangent3 weakest = Tangent3::Zero();
  double weakest_share = 0.0;
  bool is_settled = false;  ///< the last step was below a tenth of a millimetre

  /// Least overlap and least share for a pose to be believed.
  static constexpr double kLeastOverlap = 0.3;
  static constexpr double kLeastShare = 1.0e-2;
  [[nodiscard]] bool is_believed() const {
    return is_settled && after.overlap >= kLeastOverlap && weakest_share >= kLeastShare;
  }
};

/// Throws InputError if one of the clouds has fewer than a hundred points.
Alignment align_clouds(std::span<const CloudPoint> a, std::span<const CloudPoint> b, const AlignmentOptions& options);

}  // namespace gdtslam
