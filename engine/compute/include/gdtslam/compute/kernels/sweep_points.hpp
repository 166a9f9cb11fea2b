// The beams of nodding scans as points in space, equations (12) and (14) of the paper, all in float32 with additions
// and multiplications only. A strip is a run of neighbouring beams of one scan during which the crank turns evenly and
// the robot's pose moves evenly. For beam i of strip s, k = i - s.first_beam as float:
//   phase = s.phase + (i - s.first_beam) * s.phase_step                                  (wraps in 32 bits)
//   e     = table[phase >> (32 - bits)] + f * (next entry - entry), f = the phase's low bits * 2^-(32 - bits)
//   q     = range * direction[s.first_direction + (i - s.first_beam)] + lever            (nodding frame)
//   p     = (qx cos e - qz sin e - lever_x, qy, qx sin e + qz cos e - lever_z + height)  (12)
//   w     = (s.yaw + k * s.yaw_step), t = (s.x + k * s.x_step, s.y + k * s.y_step)       (13)
//   m     = Rz(w) p + (t.x, t.y, 0)              working (14); literal: Rz(w) p + (t.x * pz, t.y * pz, 0)
//   out   = (s.outer_cos mx - s.outer_sin my + s.outer_x, s.outer_sin mx + s.outer_cos my + s.outer_y, mz, e)
// A range that is not greater than 0 or not below infinity gives (0, 0, 0, e). sin and cos are sin_cos(float).
#pragma once

#include <array>
#include <cstdint>

#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

enum class SweepForm : std::uint32_t { kWorking = 0, kLiteral = 1 };

/// 16 words; beams of a strip follow each other, strips are in the order of their beams.
struct BeamStrip {
  std::uint32_t first_beam = 0;
  std::uint32_t first_direction = 0;  ///< row of the direction table that belongs to the first beam
  std::uint32_t phase = 0;            ///< at the first beam
  std::uint32_t phase_step = 0;       ///< per beam, two's complement
  float x_m = 0.0F;                   ///< pose of the sensor's place relative to the outer pose, at the first beam
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

/// Bindings: ranges (f32, metres, one per beam), strip of each beam (u32), strips (BeamStrip), directions (f32 x 4 per
/// row: x, y, z of the unit vector in the nodding frame, unused), elevations (f32, 2^bits + 1), points (f32 x 4 per
/// beam, written). A strip or direction beyond its table counts as the last one. Extent: x = beams.
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
  static constexpr std::array kBindings{Access::kRead, Access::kRead, Access::kRead,
                                        Access::kRead, Access::kRead, Access::kWrite};
  static const KernelInfo& info();
};

}  // namespace gdtslam
