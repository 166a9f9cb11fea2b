// Fields, scans and poses that the cases of several kernels share.
#pragma once

#include <vector>

#include "case_builder.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"

namespace gdtslam {

/// Structs as 32-bit words, so that a comparison covers every member.
template <class T>
CaseBuffer words_buffer(const std::vector<T>& values) {
  std::vector<std::uint32_t> words(values.size() * sizeof(T) / 4);
  if (!words.empty()) {
    std::memcpy(words.data(), values.data(), words.size() * 4);
  }
  return list_buffer(words);
}

/// A cell near the field's middle, to which poses are relative.
inline std::int32_t anchor_cell(std::uint32_t side) { return static_cast<std::int32_t>(side / 2) - 7; }

/// A field with slowly changing values, like distances, with the border of caps that kernels rely on.
std::vector<std::uint16_t> slow_field(CaseSize size, std::uint32_t cap, Random& random);

/// Points like those of a scan: within a circle of a third of the field, the first at the sensor itself.
std::vector<PointCells> scattered_points(CaseSize size, std::uint32_t count, Random& random);

/// Distances to the walls of a room with a pillar and a partition, 1/256 cell, at most the cap, which the border holds.
std::vector<std::uint16_t> room_field(CaseSize size, std::uint32_t cap, Random& random);

/// Points on those walls seen from a pose (PoseCandidate's coordinates, around anchor_cell).
std::vector<PointCells> room_points(CaseSize size, std::uint32_t count, const PoseCandidate& pose, Random& random);

/// The pose of the room's scans.
inline constexpr PoseCandidate kTruePose{2.5F, -1.25F, 0.3F, 0};

/// A field, of the room or slow, and the points of a scan in it, in the room from kTruePose.
std::vector<CaseBuffer> scene_buffers(CaseSize size, bool room, std::uint32_t cap, std::uint32_t count, Random& random);

/// Makes coordinates of each pose subnormal, in all combinations and with both signs.
void make_subnormal(std::vector<PoseCandidate>& poses);

/// The same field in strips.
void lay_in_strips(CaseSize size, std::uint32_t blank, PoseCost::Params& params, CaseBuffer& field);

/// Parameters of the cost in such a scene.
inline PoseCost::Params cost_params(CaseSize field, std::uint32_t points, std::uint32_t cap,
                                    Interpolation interpolation, CostForm form) {
  return {.width = field.width,
          .height = field.height,
          .stride = field.stride,
          .anchor_x = anchor_cell(field.width),
          .anchor_y = anchor_cell(field.height),
          .point_count = points,
          .cap = cap,
          .interpolation = interpolation,
          .form = form};
}

}  // namespace gdtslam
