// The pose of one cloud in another, from starts that may be a metre and 30 degrees off: by normal distributions from
// coarse cubes to fine ones [Magnusson2009], then by points and planes [ChenMedioni1992]. Made for rooms and buildings:
// the cubes are 2 m to 25 cm. The same on every machine. Cost: a tenth of a second for clouds of 40,000 points, and
// half of that for each further start.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/pose3.hpp"

namespace gdtslam {

enum class AlignmentMethod : std::uint8_t { kNdt, kPlane, kBoth };

/// A pose to begin from.
struct AlignmentStart {
  Pose3 T_a_b{};
  /// The height is not known: those up to 3 m above and below are tried.
  bool is_height_open = false;
};

struct AlignmentOptions {
  AlignmentMethod method = AlignmentMethod::kBoth;
  bool is_planar = false;                  ///< only x, y and yaw are looked for
  std::vector<AlignmentStart> starts{{}};  ///< at least one; the pose from the best of them is the result
  bool is_first_kept = false;              ///< the pose from the first is the result, the others are its rivals
};

/// How two clouds lie on each other.
struct CloudFit {
  double overlap = 0.0;    ///< share of b's points that have one of a within 30 cm
  double on_planes = 0.0;  ///< share of these points, where a is flat, that lie within 5 cm of its plane
  double median_m = 0.0;   ///< of the distances of these points from the planes
  [[nodiscard]] double score() const { return overlap * on_planes; }
};

struct Alignment {
  Pose3 T_a_b;
  CloudFit before;  ///< at the first start
  CloudFit after;
  /// The best pose from another start that is half a metre or 15 degrees off or more, and its fit.
  std::optional<Pose3> T_a_b_elsewhere;
  CloudFit elsewhere;
  /// Standard deviations of the position and of the turns about a's axes, by the noise of the points alone.
  Tangent3 sigma = Tangent3::Zero();
  /// The direction that the planes hold least, and the ratio of what they hold there to the most: near 0 it is free.
  /// Turns are counted at the mean distance of the points.
  Tangent3 weakest = Tangent3::Zero();
  double weakest_share = 0.0;
  bool is_first_kept = false;  ///< as in the options
  bool is_settled = false;     ///< the last step was below a tenth of a millimetre

  /// Least overlap, least share on planes and least share of the weakest direction of a result.
  static constexpr double kLeastOverlap = 0.3;
  static constexpr double kLeastOnPlanes = 0.6;
  static constexpr double kLeastShare = 1.0e-2;
  /// True if the pose elsewhere leaves about as few points unexplained; if the start was kept, if clearly fewer.
  [[nodiscard]] bool fits_elsewhere() const {
    constexpr double kAlike = 1.25;
    constexpr double kFew = 0.02;  // of the points
    if (!T_a_b_elsewhere) return false;
    const double here = 1.0 - after.score();
    const double there = 1.0 - elsewhere.score();
    return is_first_kept ? kAlike * there + kFew < here : there < kAlike * here + kFew;
  }
  [[nodiscard]] bool is_believed() const {
    return is_settled && after.overlap >= kLeastOverlap && after.on_planes >= kLeastOnPlanes &&
           weakest_share >= kLeastShare && !fits_elsewhere();
  }
};

/// The backend scores heights. Throws InputError if one of the clouds has fewer than a hundred points or fills a box of
/// more than 2^26 cubes of 1 m, DeviceError.
Alignment align_clouds(std::span<const CloudPoint> a, std::span<const CloudPoint> b, const AlignmentOptions& options,
                       Backend& backend);

}  // namespace gdtslam
