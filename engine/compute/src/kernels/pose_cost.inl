// Cost of candidate poses, paper equation (4). The arithmetic is that of the header, bit for bit.

/// Position of a coordinate in 1/256 cell.
std::int32_t quantised(float coordinate_cells) {
  constexpr float kLimit = 1073741824.0F;  // 2^30
  float position = __builtin_floorf(coordinate_cells * 256.0F + 0.5F);
  position = position > -kLimit ? position : -kLimit;
  position = position < kLimit ? position : kLimit;
  return static_cast<std::int32_t>(position);
}

/// squared_shift of the header, which calls a library template (isa/functions.hpp).
std::uint32_t shift_for(std::uint32_t cap) {
  std::uint32_t bits = 0;
  while (bits < 32 && cap >> bits != 0) {
    ++bits;
  }
  return 2 * bits > 16 ? 2 * bits - 16 : 0;
}

/// What does not change from point to point.
struct CostContext {
  const std::uint16_t* field;
  std::uint32_t stride;
  std::int32_t last_x;
  std::int32_t last_y;
  std::int32_t anchor_x;
  std::int32_t anchor_y;
  std::uint32_t cap;
  bool bilinear;
  bool squared;
  std::uint32_t shift;
};

std::uint32_t field_value(const CostContext& context, std::int32_t qx, std::int32_t qy) {
  const std::int32_t half = context.bilinear ? 128 : 0;
  const auto x = static_cast<std::uint32_t>(clamped(((qx - half) >> 8) + context.anchor_x, 0, context.last_x));
  const auto y = static_cast<std::uint32_t>(clamped(((qy - half) >> 8) + context.anchor_y, 0, context.last_y));
  const std::uint16_t* cell = context.field + at(context.stride, y) + x;
  if (!context.bilinear) {
    return cell[0];
  }
  const auto fx = static_cast<std::uint32_t>((qx - half) & 255);
  const auto fy = static_cast<std::uint32_t>((qy - half) & 255);
  const std::uint32_t lower = cell[0] * (256 - fx) + cell[1] * fx;
  const std::uint32_t upper = cell[context.stride] * (256 - fx) + cell[context.stride + 1] * fx;
  return (lower * (256 - fy) + upper * fy) >> 16U;
}

std::uint32_t candidate_cost(const CostContext& context, const PointCells* points, std::uint32_t count,
                             const PoseCandidate& pose) {
  const SinCos<float> rotation = sin_cos(pose.theta);
  const float s = rotation.sin;
  const float c = rotation.cos;
  std::uint32_t sum = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float u = (c * points[i].x - s * points[i].y) + pose.x;
    const float v = (s * points[i].x + c * points[i].y) + pose.y;
    const std::uint32_t value = lesser(field_value(context, quantised(u), quantised(v)), context.cap);
    sum += context.squared ? (value * value) >> context.shift : value;
  }
  return sum + pose.bias < sum ? 0xFFFFFFFFU : sum + pose.bias;
}

void pose_cost(const PoseCost::Params& params, const std::uint16_t* field, const PointCells* points,
               const PoseCandidate* candidates, std::uint32_t count, std::uint32_t* cost) {
  CostContext context{};
  context.field = field;
  context.stride = params.stride;
  context.last_x = static_cast<std::int32_t>(params.width) - 2;
  context.last_y = static_cast<std::int32_t>(params.height) - 2;
  context.anchor_x = params.anchor_x;
  context.anchor_y = params.anchor_y;
  context.cap = params.cap;
  context.bilinear = params.interpolation == Interpolation::kBilinear;
  context.squared = params.form == CostForm::kSquared;
  context.shift = shift_for(params.cap);
  for (std::uint32_t i = 0; i < count; ++i) {
    cost[i] = candidate_cost(context, points, params.point_count, candidates[i]);
  }
}
