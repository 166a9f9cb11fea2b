// What those who configure a matcher, a merge or a cloud choose between, and what they hand over; the kernels say what
// each does. Thread-safe.
#pragma once

#include <cstdint>

namespace gdtslam {

/// A point of the scan, in cells, in the frame of the candidates' poses.
struct PointCells {
  float x = 0.0F;
  float y = 0.0F;
};

/// How the cost reads the field between cell centres, and whether it sums distances or their squares (pose_cost).
enum class Interpolation : std::uint32_t { kBilinear = 0, kNearest = 1 };
enum class CostForm : std::uint32_t { kDistance = 0, kSquared = 1 };

/// Paper equations (9) to (11) in the working form or as printed (gdt_merge).
enum class MergeRule : std::uint32_t { kWorking = 0, kLiteral = 1 };

/// Paper equation (14) in the working form or as printed (sweep_points).
enum class SweepForm : std::uint32_t { kWorking = 0, kLiteral = 1 };

/// How the squared distances of a field are found: EdtColumns and EdtRows, or jump flooding, which errs now and then.
enum class DistanceTransform : std::uint8_t { kExact, kJumpFlood };

}  // namespace gdtslam
