// Minorants of the cost in boxes from minorants of the field: one word for each point.

struct WideBlock {
  alignas(64) float off_x[kMinorantBlock];  ///< from the centre of the point's cell
  alignas(64) float off_y[kMinorantBlock];
  alignas(64) float from_x[kMinorantBlock];  ///< the point as the robot sees it, turned by the box's angle
  alignas(64) float from_y[kMinorantBlock];
  alignas(64) float slack[kMinorantBlock];
  alignas(64) std::uint32_t cell[kMinorantBlock];
  alignas(64) std::int32_t word[kMinorantBlock];
};

inline void locate_wide(const PoseMinorantWide::Params& params, const PoseCandidate& box, const SinCos<float>& rotation,
                        const BoundPoint* points, std::uint32_t count, WideBlock& block) {
  const float bend = 0.5F * params.half_angle * params.half_angle;
  const float slack = params.slack;
  const float s = rotation.sin;
  const float c = rotation.cos;
  const float box_x = box.x;
  const float box_y = box.y;
  const std::int32_t anchor_x = params.anchor_x;
  const std::int32_t anchor_y = params.anchor_y;
  const auto width = static_cast<std::int32_t>(params.width);
  const auto height = static_cast<std::int32_t>(params.height);
  for (std::uint32_t i = 0; i < count; ++i) {
    const float x = c * points[i].x - s * points[i].y;
    const float y = s * points[i].x + c * points[i].y;
    const float u = (x + box_x) - 0.5F;
    const float v = (y + box_y) - 0.5F;
    const std::int32_t column = floor_position(u + 0.5F);
    const std::int32_t row = floor_position(v + 0.5F);
    block.off_x[i] = u - static_cast<float>(column);
    block.off_y[i] = v - static_cast<float>(row);
    block.from_x[i] = x;
    block.from_y[i] = y;
    block.slack[i] = slack + bend * (absolute(x) + absolute(y));
    block.cell[i] = points[i].field + static_cast<std::uint32_t>(clamped(row + anchor_y, 0, height - 1) * width +
                                                                 clamped(column + anchor_x, 0, width - 1));
  }
}

/// Fills a block up to whole vectors with words that say nothing.
inline std::uint32_t fill_up(std::uint32_t count, WideBlock& block) {
  const std::uint32_t whole = (count + kMinorantLanes - 1) / kMinorantLanes * kMinorantLanes;
  for (std::uint32_t i = count; i < whole; ++i) {
    block.word[i] = 0;
    block.off_x[i] = block.off_y[i] = block.from_x[i] = block.from_y[i] = block.slack[i] = 0.0F;
  }
  return whole;
}

inline void add_wide(std::int32_t unit, std::uint32_t count, const WideBlock& block, PoseMinorant::Value& total) {
  constexpr auto kSlope = static_cast<float>(FieldMinorant::kSlopeUnit);
  std::int32_t constant = 0;
  std::int32_t slope_x = 0;
  std::int32_t slope_y = 0;
  std::int32_t slope_theta = 0;
  count = count / kMinorantLanes * kMinorantLanes;  // it is; the compiler may know
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::int32_t word = block.word[i];
    const std::int32_t whole_x = (word << 8) >> 24;
    const std::int32_t whole_y = word >> 24;
    const std::int32_t height = ((word << 16) >> 16) * unit;
    const float gx = kSlope * static_cast<float>(whole_x);
    const float gy = kSlope * static_cast<float>(whole_y);
    const float here = gx * block.off_x[i] + gy * block.off_y[i];
    const float lost = (absolute(gx) + absolute(gy)) * block.slack[i];
    const float turn = (gy * block.from_x[i] - gx * block.from_y[i]) * (1.0F / PoseMinorant::kThetaStep);
    constant += height + floor_position(here - lost);
    slope_x += whole_x;
    slope_y += whole_y;
    slope_theta += floor_position(turn);
  }
  total.constant += constant;
  total.slope_x += slope_x * FieldMinorant::kSlopeUnit;
  total.slope_y += slope_y * FieldMinorant::kSlopeUnit;
  total.slope_theta += slope_theta;
}

void pose_minorant_wide(const PoseMinorantWide::Params& params, const std::uint32_t* minorants,
                        const BoundPoint* points, const PoseCandidate* boxes, std::uint32_t count,
                        PoseMinorant::Value* values) {
  WideBlock block;
  for (std::uint32_t b = 0; b < count; ++b) {
    const SinCos<float> rotation = sin_cos(boxes[b].theta);
    PoseMinorant::Value total;
    for (std::uint32_t first = 0; first < params.point_count; first += kMinorantBlock) {
      const std::uint32_t in_block = lesser(kMinorantBlock, params.point_count - first);
      locate_wide(params, boxes[b], rotation, points + first, in_block, block);
      for (std::uint32_t i = 0; i < in_block; ++i) {
        block.word[i] = static_cast<std::int32_t>(minorants[block.cell[i]]);
      }
      add_wide(static_cast<std::int32_t>(params.constant_unit), fill_up(in_block, block), block, total);
      // Terms are rounded down by less than a unit, and float32 is off by less than another.
      total.constant -= static_cast<std::int32_t>(2 * in_block);
    }
    values[b] = total;
  }
}
