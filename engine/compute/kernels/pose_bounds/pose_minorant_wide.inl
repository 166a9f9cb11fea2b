// Minorants of the cost in boxes from minorants of the field: one word for each point.

/// Points of a block, whole vectors of them: loops without remainders are twice as fast.
struct WidePoints {
  alignas(64) float x[kMinorantBlock];
  alignas(64) float y[kMinorantBlock];
  alignas(64) std::uint32_t field[kMinorantBlock];
  std::uint32_t count = 0;  ///< number of points that count
  std::uint32_t whole = 0;
};

struct WideBlock {
  alignas(64) float off_x[kMinorantBlock];  ///< from the centre of the point's cell
  alignas(64) float off_y[kMinorantBlock];
  alignas(64) float from_x[kMinorantBlock];  ///< the point seen from the robot, turned by the box's angle
  alignas(64) float from_y[kMinorantBlock];
  alignas(64) std::uint32_t cell[kMinorantBlock];
  alignas(64) std::int32_t word[kMinorantBlock];
};

inline void take_points(const BoundPoint* points, std::uint32_t count, WidePoints& taken) {
  taken.count = count;
  taken.whole = (count + kMinorantLanes - 1) / kMinorantLanes * kMinorantLanes;
  for (std::uint32_t i = 0; i < taken.whole; ++i) {
    const BoundPoint& point = points[i < count ? i : 0];
    taken.x[i] = point.x;
    taken.y[i] = point.y;
    taken.field[i] = point.field;
  }
}

inline void locate_wide(const PoseMinorantWide::Params& params, const PoseCandidate& box, const SinCos<float>& rotation,
                        const WidePoints& points, WideBlock& block) {
  const float s = rotation.sin;
  const float c = rotation.cos;
  const float box_x = box.x;
  const float box_y = box.y;
  const std::int32_t anchor_x = params.anchor_x;
  const std::int32_t anchor_y = params.anchor_y;
  const auto width = static_cast<std::int32_t>(params.width);
  const auto height = static_cast<std::int32_t>(params.height);
  const std::uint32_t whole = points.whole / kMinorantLanes * kMinorantLanes;  // no-op: shows the compiler the multiple
  for (std::uint32_t i = 0; i < whole; ++i) {
    const float x = c * points.x[i] - s * points.y[i];
    const float y = s * points.x[i] + c * points.y[i];
    const float u = (x + box_x) - 0.5F;
    const float v = (y + box_y) - 0.5F;
    const std::int32_t column = floor_position(u + 0.5F);
    const std::int32_t row = floor_position(v + 0.5F);
    block.off_x[i] = u - static_cast<float>(column);
    block.off_y[i] = v - static_cast<float>(row);
    block.from_x[i] = x;
    block.from_y[i] = y;
    block.cell[i] = points.field[i] + static_cast<std::uint32_t>(clamped(row + anchor_y, 0, height - 1) * width +
                                                                 clamped(column + anchor_x, 0, width - 1));
  }
}

/// Single loads beat gather instructions (pose_cost.inl). Words of padding points have no meaning.
inline void read_words(const std::uint32_t* minorants, const WidePoints& points, WideBlock& block) {
  for (std::uint32_t i = 0; i < points.count; ++i) {
    __builtin_memcpy(&block.word[i], minorants + block.cell[i], 4);
  }
  for (std::uint32_t i = points.count; i < points.whole; ++i) {
    block.word[i] = 0;
  }
}

inline void add_wide(const PoseMinorantWide::Params& params, std::uint32_t count, const WideBlock& block,
                     PoseMinorant::Value& total) {
  const auto unit = static_cast<std::int32_t>(params.constant_unit);
  const float bend = 0.5F * params.half_angle * params.half_angle;
  const float slack = params.slack;
  constexpr auto kSlope = static_cast<float>(FieldMinorant::kSlopeUnit);
  std::int32_t constant = 0;
  std::int32_t slope_x = 0;
  std::int32_t slope_y = 0;
  std::int32_t slope_theta = 0;
  count = count / kMinorantLanes * kMinorantLanes;  // no-op: shows the compiler the multiple
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::int32_t word = block.word[i];
    const std::int32_t whole_x = (word << 8) >> 24;
    const std::int32_t whole_y = word >> 24;
    const std::int32_t height = ((word << 16) >> 16) * unit;
    const float gx = kSlope * static_cast<float>(whole_x);
    const float gy = kSlope * static_cast<float>(whole_y);
    const float here = gx * block.off_x[i] + gy * block.off_y[i];
    const float off = slack + bend * (absolute(block.from_x[i]) + absolute(block.from_y[i]));
    const float lost = (absolute(gx) + absolute(gy)) * off;
    const float turn = (gy * block.from_x[i] - gx * block.from_y[i]) * (1.0F / PoseMinorant::kThetaStep);
    constant += height + floor_to_int32(here - lost);
    slope_x += whole_x;
    slope_y += whole_y;
    slope_theta += floor_to_int32(turn);
  }
  total.constant += constant;
  total.slope_x += slope_x * FieldMinorant::kSlopeUnit;
  total.slope_y += slope_y * FieldMinorant::kSlopeUnit;
  total.slope_theta += slope_theta;
}

void pose_minorant_wide(const PoseMinorantWide::Params& params, const std::uint32_t* minorants,
                        const BoundPoint* points, const PoseCandidate* boxes, std::uint32_t count,
                        PoseMinorant::Value* values) {
  WidePoints taken;
  WideBlock block;
  for (std::uint32_t b = 0; b < count; ++b) {
    values[b] = {};
  }
  for (std::uint32_t first = 0; first < params.point_count; first += kMinorantBlock) {
    const std::uint32_t in_block = lesser(kMinorantBlock, params.point_count - first);
    take_points(points + first, in_block, taken);
    for (std::uint32_t b = 0; b < count; ++b) {
      locate_wide(params, boxes[b], sin_cos(boxes[b].theta), taken, block);
      read_words(minorants, taken, block);
      add_wide(params, taken.whole, block, values[b]);
      // Terms are rounded down by less than a unit, and float32 is off by less than another.
      values[b].constant -= static_cast<std::int32_t>(2 * in_block);
    }
  }
}
