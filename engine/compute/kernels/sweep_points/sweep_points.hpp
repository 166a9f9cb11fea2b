// The beams of nodding scans as points in space, equations (12) and (14) of the paper, all in float32 with additions
// and multiplications only, each rounded by itself in the order of the brackets. A strip is a run of neighbouring beams
// of one scan during which the crank turns evenly and the robot's pose moves evenly. For beam i of strip s, with
// j = i - s.first_beam (wraps in 32 bits) and k = its low 24 bits as float:
//   phase = s.phase + j * s.phase_step                                              (wraps in 32 bits)
//   e  = settled(entry + f * (next - entry)), entry number phase >> (32 - bits), f = ((phase << bits) >> 8) * 2^-24
//   q  = range * direction[s.first_direction + j] + (lever_x, 0, lever_z)           (nodding frame; y has no addition)
//   px = (qx cos e - qz sin e) - lever_x, py = qy, up = (qx sin e + qz cos e) - lever_z, pz = up + height      (12)
//   w  = s.yaw + k * s.yaw_step, tx = s.x + k * s.x_step, ty = s.y + k * s.y_step                              (13)
//   literal (14): tx and ty times `up`, the paper's P_Z; working (14): as they are
//   mx = (px cos w - py sin w) + tx, my = (px sin w + py cos w) + ty
//   out = ((s.outer_cos mx - s.outer_sin my) + s.outer_x, (s.outer_sin mx + s.outer_cos my) + s.outer_y, pz, e)
// sin and cos are sin_cos(float). settled(v) is +0 if v is not finite or below 2^-40 in size, so that no result
// depends on how a device treats subnormals and NaN; the three coordinates are settled too. A range that is not greater
// than 0 or not below infinity, and a point with a coordinate that is not finite, give (0, 0, 0, e).
#pragma once

#include <array>
#include <cstdint>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

struct CaseGroup;

/// Measured range of a beam, and the beam's indices.
struct BeamRange {
  float range_m = 0.0F;
  std::uint32_t strip = 0;
};
static_assert(sizeof(BeamRange) == 8);

/// 16 words; beams of a strip follow each other, strips are in the order of their beams.
struct BeamStrip {
  std::uint32_t first_beam = 0;
  std::uint32_t first_direction = 0;  ///< row of the direction table for the first beam
  std::uint32_t phase = 0;            ///< at the first beam
  std::uint32_t phase_step = 0;       ///< per beam, two's complement
  float x_m = 0.0F;                   ///< pose of the sensor relative to the outer pose, at the first beam
  float y_m = 0.0F;
  float yaw_rad = 0.0F;
  float x_step_m = 0.0F;  ///< per beam
  float y_step_m = 0.0F;
  float yaw_step_rad = 0.0F;
  float outer_x_m = 0.0F;  ///< T_t of (14), relative to the caller's anchor
  float outer_y_m = 0.0F;
  float outer_cos = 1.0F;
  float outer_sin = 0.0F;
  std::uint32_t unused_0 = 0;
  std::uint32_t unused_1 = 0;
};
static_assert(sizeof(BeamStrip) == 64);

/// Bindings: beams (BeamRange), strips (BeamStrip), tables (f32: 2^bits + 1 elevations, then the directions, x, y and z
/// of a unit vector in the nodding frame each), points (f32 x 4 per beam, written). Four bindings are the number that
/// every Vulkan device supports. A strip or direction beyond its table counts as the last one. Extent: x = beams.
struct SweepPoints {
  struct Params {
    std::uint32_t beams = 0;
    std::uint32_t strips = 0;
    std::uint32_t directions = 0;
    std::uint32_t table_bits = 0;  ///< 0 to 20
    float lever_x_m = 0.0F;
    float lever_z_m = 0.0F;
    float height_m = 0.0F;
    SweepForm form = SweepForm::kWorking;
  };
  static constexpr std::array kBindings{Access::kRead, Access::kRead, Access::kRead, Access::kWrite};
  /// Number of table values before the first direction.
  static constexpr std::size_t elevations(std::uint32_t table_bits) { return (std::size_t{1} << table_bits) + 1; }
  static const KernelInfo& info();
  static CaseGroup cases();
};

}  // namespace gdtslam
