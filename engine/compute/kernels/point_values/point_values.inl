// The field under points: positions in vectors, then single loads.

constexpr std::uint32_t kValueBlock = 128;

/// Cell of a coordinate, 0 to `last`.
inline std::uint32_t held_cell(float coordinate, float anchor, float last) {
  const float cell = static_cast<float>(floor_position(coordinate)) + anchor;
  const float above = cell > 0.0F ? cell : 0.0F;
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(above < last ? above : last));
}

void point_values(const PointValues::Params& grid, const std::uint16_t* field, const PointCells* points,
                  const PointValues::Pose& pose, std::uint16_t* values) {
  const SinCos<float> rotation = sin_cos(pose.theta);
  const auto anchor_x = static_cast<float>(grid.anchor_x);
  const auto anchor_y = static_cast<float>(grid.anchor_y);
  const auto last_x = static_cast<float>(grid.width - 1);
  const auto last_y = static_cast<float>(grid.height - 1);
  const std::uint32_t strip_step = grid.strip - kStripWidth;
  std::uint32_t cell[kValueBlock];
  for (std::uint32_t first = 0; first < grid.point_count; first += kValueBlock) {
    const std::uint32_t count = lesser(kValueBlock, grid.point_count - first);
    const PointCells* block = points + first;
    for (std::uint32_t i = 0; i < count; ++i) {
      const float u = (rotation.cos * block[i].x - rotation.sin * block[i].y) + pose.x;
      const float v = (rotation.sin * block[i].x + rotation.cos * block[i].y) + pose.y;
      cell[i] = field_place(held_cell(u, anchor_x, last_x), held_cell(v, anchor_y, last_y), grid.stride, strip_step);
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      values[first + i] = u16(u32(field[cell[i]]) ^ grid.blank);
    }
  }
}
