// Lower bounds of the cost of pose_cost.hpp (bilinear, distance) over boxes of poses, by which the matcher `certified`
// prunes. docs/numerics.md, "Certified matching", derives both. Frames and units as in pose_cost.hpp: cells and radians
// relative to the lower left corner of an anchor cell. Thread-safe; linear in points times boxes.
#pragma once

#include <array>
#include <cstdint>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// A point and the index of its dilated field: the farther a point lies from the robot, the more a box's half angle
/// moves it, so the wider is the dilation it needs.
struct BoundPoint {
  float x = 0.0F;
  float y = 0.0F;
  std::uint32_t field = 0;  ///< index of the first sample of the dilation's planes
};

/// Sums of a dilated field under the points for tiles of boxes that share an angle. The field is bytes: samples
/// 2^-sample_shift cells apart (a negative shift: closer than a cell), each the least value of a square around it. They
/// are stored as planes so that boxes one spacing, 2^phase_bits samples, apart lie side by side: sample (u, v) is
/// column u >> phase_bits, row v >> phase_bits of plane (v & mask) * (mask + 1) + (u & mask), mask = 2^phase_bits - 1,
/// a plane being `height` rows of `width` bytes.
///
/// Per tile s, c = sin_cos(theta) in float32; per point, without contraction, u = floor(((c*x - s*y) + tile.x) * scale
/// + bias) with scale = samples per cell and bias = (0.5 - 0.5 * scale) + 2^phase_bits, v likewise with (s*x + c*y) +
/// tile.y. The floor is clamped to +-2^30 as in pose_cost.hpp (NaN: -2^30). Column (u >> phase_bits) - 1 + first_column
/// and row (v >> phase_bits) - 1 + first_row are clamped to [0, width - tile_width] and [0, height - tile_height], and
/// the tile's boxes read tile_width columns of tile_height rows from there, in the planes that begin at the lesser of
/// the point's `field` and `last_field`. Box (i, j) has index j * tile_width + i. The bias adds a spacing that the 1
/// removes. So no position near 0 depends on the sign of a value below 2^-126, which a device may drop.
///
/// Bindings: field (u8, read), points (BoundPoint, read), tiles (PoseCandidate, read; the bias is not), sums (u32,
/// write; tile_width * tile_height a tile). Extent: x = tiles.
struct PoseBounds {
  struct Params {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::int32_t first_column = 0;  ///< first column of the anchor, margin included; at most kFarthestFirst off
    std::int32_t first_row = 0;
    std::uint32_t phase_bits = 0;  ///< at most 4
    float samples_per_cell = 1.0F;
    std::uint32_t point_count = 0;  ///< at most 65,537
    std::uint32_t last_field = 0;   ///< first sample of the last dilation
    std::uint32_t tile_width = 2;   ///< 2 x 2 or 16 x 4
    std::uint32_t tile_height = 2;
  };
  static constexpr std::int32_t kFarthestFirst = 1 << 21;
  static constexpr std::array kBindings{Access::kRead, Access::kRead, Access::kRead, Access::kWrite};
  static const KernelInfo& info();
  static CaseGroup cases();
};

/// An affine function below the field in the square of half width `reach` cells around each cell's centre, also between
/// cells, where the field is interpolated: f(centre + (dx, dy)) >= constant * constant_unit + kSlopeUnit * (slope_x *
/// dx + slope_y * dy). A word: the constant in its low 16 bits (signed), then the slopes, 8 bits each. slope_x is the
/// sum over the rows j = -reach, 0, reach of field(reach, j) - field(-reach, j), divided by 6 * reach * kSlopeUnit,
/// rounded towards zero and clamped to +-127; slope_y likewise; the constant is the least of field - kSlopeUnit *
/// (slope_x * i + slope_y * j) over the square's cells, divided by the unit, rounded down. Outside the field counts as
/// the cap. The result reaches kMargin cells beyond the field on every side, where it is the cap.
struct FieldMinorant {
  struct Params {
    std::uint32_t width = 0;  ///< width of the field
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
    std::uint32_t cap = 0;
    std::uint32_t reach = 1;  ///< 1, 2 or 3
    std::uint32_t constant_unit = 1;
  };
  static constexpr std::uint32_t kMargin = 4;
  static constexpr std::int32_t kSlopeUnit = 3;
  static constexpr std::uint32_t unit_for(std::uint32_t cap) { return cap / 32767U + 1U; }
};

/// An affine function that lies below the cost in a box of poses, in 1/256 cell: cost(centre + (dx, dy, dt)) >=
/// constant
/// + slope_x * dx + slope_y * dy + slope_theta * kThetaStep * dt - point_count * kThetaStep * |dt|.
struct PoseMinorant {
  struct Params {
    std::uint32_t width = 0;  ///< width of the field, at least 4 like its height
    std::uint32_t height = 0;
    std::uint32_t stride = 0;
    std::int32_t anchor_x = 0;
    std::int32_t anchor_y = 0;
    std::uint32_t point_count = 0;  ///< at most kMostPoints
    std::uint32_t cap = 0;          ///< cells above count as this
    float half_width = 0.0F;        ///< half width of the box along x and y, cells
    float half_angle = 0.0F;
    float slack = 0.0F;  ///< cells that rounding may move a point by
  };
  struct Value {
    std::int32_t constant = 0;
    std::int32_t slope_x = 0;  ///< per cell
    std::int32_t slope_y = 0;
    std::int32_t slope_theta = 0;  ///< per kThetaStep'th of a radian: rounded down
  };
  static constexpr std::int32_t kThetaStep = 16;
  static constexpr std::uint32_t kMostPoints = 4096;
  /// Points farther from the robot than this, |x| + |y| in cells, do not count, and slopes of a point's minorant stay
  /// within +-kMostSlope, so that no sum overflows.
  static constexpr float kFarthest = 8192.0F;
  static constexpr std::int32_t kMostSlope = 511;
};

/// The same from fields of minorants, for boxes too large for patches. A point's `field` is the first index of the
/// field with sufficient reach. Per point u = ((c*x - s*y) + box.x) - 0.5, column i = floor(u + 0.5), the minorant is
/// that of cell i, plus anchor and margin and clamped, taken at u - i. Points lie within kFarthest.
struct PoseMinorantWide {
  struct Params {
    std::uint32_t width = 0;  ///< width of a field of minorants
    std::uint32_t height = 0;
    std::int32_t anchor_x = 0;  ///< margin included
    std::int32_t anchor_y = 0;
    std::uint32_t point_count = 0;
    std::uint32_t constant_unit = 1;
    float half_angle = 0.0F;
    float slack = 0.0F;
  };
};

}  // namespace gdtslam
