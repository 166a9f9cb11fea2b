// Cost of candidate poses, paper equation (4). The arithmetic is that of the header, bit for bit. The rearrangements
// here are exact: integers, and a clamp before the floor instead of after it, with integer limits.

/// squared_shift of the header, which calls a library template (engine/compute/cpu/functions.hpp).
std::uint32_t shift_for(std::uint32_t cap) {
  std::uint32_t bits = 0;
  while (bits < 32 && cap >> bits != 0) {
    ++bits;
  }
  return 2 * bits > 16 ? 2 * bits - 16 : 0;
}

/// Values that are the same for all points. Positions are in 1/256 cell.
struct CostContext {
  const std::uint16_t* field;
  const PointCells* points;
  std::uint32_t count;
  std::uint32_t stride;
  std::uint32_t strip_step;  ///< from a strip's 64 columns to the next strip, 0 for rows (kernel.hpp)
  std::uint32_t blank;       ///< twice, one for each of two neighbours
  std::int32_t last_x;  ///< largest cell that may be read with its right neighbour
  std::int32_t last_y;
  std::int32_t shift_x;  ///< the anchor, and minus half a cell when bilinear
  std::int32_t shift_y;
  std::uint32_t cap;
  std::uint32_t square_shift;
};

/// A candidate's rotation and translation, float32.
struct CostPose {
  float s;
  float c;
  float x;
  float y;
};

/// FieldLayout::place in 32 bits.
inline std::uint32_t field_place(std::uint32_t x, std::uint32_t y, std::uint32_t stride, std::uint32_t strip_step) {
  return y * stride + x + x / kStripWidth * strip_step;
}

/// Limit to which coordinates are clamped, 1/256 cell: far off any map, and an integer of float32 and int32 alike.
constexpr float kFarthestPosition = 1073741824.0F;  // 2^30

/// floor of a clamped position; NaN counts as -2^30.
inline std::int32_t floor_position(float position) {
  position = position > -kFarthestPosition ? position : -kFarthestPosition;
  position = position < kFarthestPosition ? position : kFarthestPosition;
  const auto truncated = static_cast<std::int32_t>(position);
  return truncated - (static_cast<float>(truncated) > position ? 1 : 0);
}

/// Points of a block: enough that the stores of cells have reached the cache when they are looked up.
constexpr std::uint32_t kCostBlock = 128;

/// A block of points between two steps: the cells are located, and their values are added.
struct CostBlock {
  alignas(64) std::uint32_t cell[kCostBlock];  ///< at most (width - 2, height - 2), so neighbours are inside as well
  alignas(64) std::int32_t position_x[kCostBlock];  ///< the low byte is the fraction
  alignas(64) std::int32_t position_y[kCostBlock];
  alignas(64) float turned_x[kCostBlock];  ///< rotated, not translated
};

#if GDTSLAM_ISA_LEVEL > 0
#include "pose_cost_vector.inl"
#else
#include "pose_cost_portable.inl"
#endif

/// Sum of the terms of all points.
template <bool kBilinear, bool kSquared>
std::uint32_t point_sum(const CostContext& context, const CostPose& pose) {
  CostBlock block;
  BlockSteps<kBilinear, kSquared> steps(context, pose);
  for (std::uint32_t first = 0; first < context.count; first += kCostBlock) {
    const std::uint32_t count = lesser(kCostBlock, context.count - first);
    steps.locate(context.points + first, count, block);
    steps.add_values(block, count);
  }
  return steps.sum();
}

#if GDTSLAM_ISA_LEVEL == 2
/// Sums of the first candidates that form a row (BlockSteps::add_row_values); returns how many. Short rows do not pay.
template <bool kBilinear, bool kSquared>
std::uint32_t row_sums(const CostContext& context, const CostPose& pose, const PoseCandidate* candidates,
                       std::uint32_t count, std::uint32_t* sums) {
  const PoseCandidate& first = candidates[0];
  std::uint32_t length = 1;
  while (length < lesser(count, kLanes) && candidates[length].theta == first.theta && candidates[length].y == first.y &&
         candidates[length].x >= first.x && candidates[length].x - first.x <= 30.0F) {
    ++length;
  }
  if (length < 5 || context.strip_step == 0) {
    sums[0] = point_sum<kBilinear, kSquared>(context, pose);
    return 1;
  }
  const Ints lane_candidates = lesser(lane_numbers(), all(static_cast<std::int32_t>(length - 1)));
  const Floats x = _mm512_i32gather_ps(shift_left<2>(lane_candidates), &candidates->x, sizeof(float));
  CostBlock block;
  BlockSteps<kBilinear, kSquared> steps(context, pose);
  for (std::uint32_t i = 0; i < context.count; i += kCostBlock) {
    const std::uint32_t points = lesser(kCostBlock, context.count - i);
    steps.locate(context.points + i, points, block);
    steps.add_row_values(block, points, x);
  }
  _mm512_mask_storeu_epi32(sums, static_cast<__mmask16>((1U << length) - 1U), steps.sums());
  return length;
}
#endif

template <bool kBilinear, bool kSquared>
void candidate_costs(const CostContext& context, const PoseCandidate* candidates, std::uint32_t* cost, Slice slice) {
  SinCos<float> rotation{};
  for (std::uint32_t i = slice.begin; i < slice.end;) {
    const bool is_turned = i == slice.begin || candidates[i].theta != candidates[i - 1].theta;
    rotation = is_turned ? sin_cos(candidates[i].theta) : rotation;
    const CostPose pose{rotation.sin, rotation.cos, candidates[i].x, candidates[i].y};
#if GDTSLAM_ISA_LEVEL == 2
    i += row_sums<kBilinear, kSquared>(context, pose, candidates + i, slice.end - i, cost + i);
#else
    cost[i++] = point_sum<kBilinear, kSquared>(context, pose);
#endif
  }
  for (std::uint32_t i = slice.begin; i < slice.end; ++i) {
    const std::uint32_t total = cost[i] + candidates[i].bias;
    cost[i] = total < cost[i] ? 0xFFFFFFFFU : total;
  }
}

CostContext cost_context(const PoseCost::Params& params, const std::uint16_t* field, const PointCells* points) {
  const std::int32_t half_cell = params.interpolation == Interpolation::kBilinear ? 128 : 0;
  return {field,
          points,
          params.point_count,
          params.stride,
          params.strip - kStripWidth,
          params.blank << 16U | params.blank,
          static_cast<std::int32_t>(params.width) - 2,
          static_cast<std::int32_t>(params.height) - 2,
          params.anchor_x * 256 - half_cell,
          params.anchor_y * 256 - half_cell,
          params.cap,
          shift_for(params.cap)};
}

void pose_cost(const PoseCost::Params& params, const std::uint16_t* field, const PointCells* points,
               const PoseCandidate* candidates, std::uint32_t* cost, Slice slice) {
  const bool squared = params.form == CostForm::kSquared;
  const CostContext context = cost_context(params, field, points);
  if (params.interpolation == Interpolation::kBilinear) {
    squared ? candidate_costs<true, true>(context, candidates, cost, slice)
            : candidate_costs<true, false>(context, candidates, cost, slice);
  } else {
    squared ? candidate_costs<false, true>(context, candidates, cost, slice)
            : candidate_costs<false, false>(context, candidates, cost, slice);
  }
}
