// Normal equations of a scan's points on the lines of another scan: each point is paired with the nearest surface point
// in about the same direction, whose normal makes it a line [Censi2008]. On the host only. Metres and radians.
//
// Arithmetic (docs/numerics.md), float32 without contraction, the same bits on every instruction set. The candidates of
// a point are the kCandidates lines from kBefore before the first one of its bin of directions; the nearest counts, the
// first of those whose squared distances differ by less than 2^-19 of them. Point i is added to lane i % kLanes; the
// lanes of a sum are added in order, as double.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace gdtslam {

struct PointToLine {
  static constexpr std::uint32_t kLanes = 16;
  static constexpr std::uint32_t kCandidates = 16;
  static constexpr std::int32_t kBefore = 6;
  static constexpr std::uint32_t kBins = 256;  ///< bins of pseudo_bearing(), -2 to 2
  static constexpr std::int32_t kNone = -1;    ///< the point is on no line
  struct Point {
    float x = 0.0F;
    float y = 0.0F;
    float normal_x = 0.0F;
    float normal_y = 0.0F;
  };
  /// Surface points in the order of their directions, padded with points far away to kCandidates.
  struct Lines {
    const Point* points = nullptr;
    const float* x = nullptr;  ///< all x, and all y
    const float* y = nullptr;
    std::int32_t count = 0;                ///< with the padding
    const std::uint16_t* first = nullptr;  ///< the first point in or after each bin
    float low = 0.0F;                      ///< directions that the scan sees
    float high = 0.0F;
  };
  /// The points taken from the moving scan, and its pose in the frame of the lines.
  struct Params {
    float x = 0.0F;
    float y = 0.0F;
    float sin = 0.0F;
    float cos = 1.0F;
    float gate_m = 0.15F;
    float kernel_m = 0.045F;        ///< scale of the kernel of Geman and McClure
    float least_cosine = 0.8F;      ///< between the normals of a point and of its line
    std::uint32_t every = 1;        ///< stride through the points
    std::uint32_t point_count = 0;  ///< number of points taken
  };
  /// Sums over the points, each by its weight: information xx, xy, xt, yy, yt, tt and gradient x, y, t for motions on
  /// the right of the pose; the weights; the squared distances from the lines.
  static constexpr std::size_t kSums = 11;
  using Sums = std::array<double, kSums>;
};

}  // namespace gdtslam
