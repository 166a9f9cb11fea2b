// Truncated exact distance transform, two separable passes.

void edt_columns(const EdtColumns::Params& params, const std::uint8_t* seeds, std::uint8_t* distance,
                 std::uint32_t begin, std::uint32_t end) {
  const std::uint32_t radius = params.radius;
  for (std::uint32_t x = begin; x < end; ++x) {
    const bool seed = seeds[x] != 0;
    distance[x] = u8(seed ? 0 : radius);
  }
  for (std::uint32_t y = 1; y < params.height; ++y) {
    const std::uint8_t* seed = seeds + at(params.stride, y);
    std::uint8_t* row = distance + at(params.stride, y);
    const std::uint8_t* above = row - params.stride;
    for (std::uint32_t x = begin; x < end; ++x) {
      row[x] = u8(seed[x] != 0 ? 0 : lesser(above[x] + 1U, radius));
    }
  }
  for (std::uint32_t y = params.height - 1; y-- > 0;) {
    std::uint8_t* row = distance + at(params.stride, y);
    const std::uint8_t* below = row + params.stride;
    for (std::uint32_t x = begin; x < end; ++x) {
      row[x] = u8(lesser(row[x], below[x] + 1U));
    }
  }
}

// One row: squares of the column distances between margins of R cells that hold R*R, then the minimum over 2R+1
// offsets.
void edt_rows(const EdtRows::Params& params, const std::uint8_t* distance, std::uint16_t* sq_distance,
              std::uint32_t begin, std::uint32_t end, std::uint16_t* scratch) {
  const std::uint32_t radius = params.radius;
  const std::uint16_t sq_radius = u16(radius * radius);
  std::uint16_t* squares = scratch + radius;
  for (std::uint32_t i = 0; i < radius; ++i) {
    scratch[i] = sq_radius;
    squares[params.width + i] = sq_radius;
  }
  for (std::uint32_t y = begin; y < end; ++y) {
    const std::uint8_t* in = distance + at(params.stride, y);
    std::uint16_t* out = sq_distance + at(params.stride, y);
    for (std::uint32_t x = 0; x < params.width; ++x) {
      squares[x] = u16(static_cast<std::uint32_t>(in[x]) * in[x]);
      out[x] = squares[x];
    }
    for (std::uint32_t dx = 1; dx < radius; ++dx) {
      const std::uint16_t* left = squares - dx;
      const std::uint16_t* right = squares + dx;
      for (std::uint32_t x = 0; x < params.width; ++x) {
        const std::uint32_t beside = lesser(left[x], right[x]) + dx * dx;
        out[x] = u16(lesser(out[x], beside));
      }
    }
  }
}
