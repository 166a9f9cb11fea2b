// Sums of dilated fields over tiles of boxes. Points are processed in blocks: first the position of each one, in
// vectors, then the bytes there, which are added in 16 bits: a block has too few points to overflow them.

constexpr std::uint32_t kBoundBlock = 128;

/// Computes the first byte that each point of a block reads.
void locate_tiles(const PoseBounds::Params& params, const BoundPoint* points, std::uint32_t count,
                  const PoseCandidate& tile, const SinCos<float>& rotation, std::uint32_t* offsets) {
  const float scale = params.samples_per_cell;
  const auto bits = static_cast<int>(params.phase_bits);
  const float bias = (0.5F - 0.5F * scale) + static_cast<float>(1 << bits);
  const float s = rotation.sin;
  const float c = rotation.cos;
  const float x = tile.x;
  const float y = tile.y;
  const std::int32_t mask = (1 << bits) - 1;
  const auto width = static_cast<std::int32_t>(params.width);
  const std::int32_t last_column = width - static_cast<std::int32_t>(params.tile_width);
  const std::int32_t last_row = static_cast<std::int32_t>(params.height - params.tile_height);
  const std::int32_t first_column = params.first_column - 1;
  const std::int32_t first_row = params.first_row - 1;
  const std::uint32_t last_field = params.last_field;
  const std::int32_t plane = width * static_cast<std::int32_t>(params.height);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::int32_t u = floor_position(((c * points[i].x - s * points[i].y) + x) * scale + bias);
    const std::int32_t v = floor_position(((s * points[i].x + c * points[i].y) + y) * scale + bias);
    const std::int32_t column = clamped((u >> bits) + first_column, 0, last_column);
    const std::int32_t row = clamped((v >> bits) + first_row, 0, last_row);
    const std::int32_t phase = ((v & mask) << bits) + (u & mask);
    offsets[i] = lesser(points[i].field, last_field) + static_cast<std::uint32_t>(phase * plane + row * width + column);
  }
}

/// A tile of 2 x 2: its four bytes become a word, columns in turn, and the words of a block are added as two pairs of
/// 16 bits each.
void add_small_tile(const std::uint8_t* field, std::uint32_t width, const std::uint32_t* offsets, std::uint32_t count,
                    std::uint32_t* sums) {
  alignas(64) std::uint32_t words[kBoundBlock];
  const std::uint8_t* above = field + width;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint16_t lower;
    std::uint16_t upper;
    __builtin_memcpy(&lower, field + offsets[i], 2);
    __builtin_memcpy(&upper, above + offsets[i], 2);
    words[i] = lower | static_cast<std::uint32_t>(upper) << 16U;
  }
  std::uint32_t lefts = 0;
  std::uint32_t rights = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    lefts += words[i] & 0x00FF00FFU;
    rights += words[i] >> 8U & 0x00FF00FFU;
  }
  sums[0] += lefts & 0xFFFFU;
  sums[1] += rights & 0xFFFFU;
  sums[2] += lefts >> 16U;
  sums[3] += rights >> 16U;
}

constexpr std::uint32_t kWideTile = 16;
constexpr std::uint32_t kWideTileRows = 4;

/// A row of tiles of 16 x 4.
void add_wide_row(const std::uint8_t* field, const std::uint32_t* offsets, std::uint32_t count, std::uint32_t* sums) {
  std::uint16_t row[kWideTile] = {};
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint8_t* at = field + offsets[i];
    for (std::uint32_t k = 0; k < kWideTile; ++k) {
      row[k] = static_cast<std::uint16_t>(row[k] + at[k]);
    }
  }
  for (std::uint32_t k = 0; k < kWideTile; ++k) {
    sums[k] += row[k];
  }
}

void pose_bounds(const PoseBounds::Params& params, const std::uint8_t* field, const BoundPoint* points,
                 const PoseCandidate* tiles, std::uint32_t* sums, Slice slice) {
  const std::uint32_t boxes = params.tile_width * params.tile_height;
  alignas(64) std::uint32_t offsets[kBoundBlock];
  for (std::uint32_t t = slice.begin; t < slice.end; ++t) {
    std::uint32_t* tile_sums = sums + std::size_t{t} * boxes;
    for (std::uint32_t i = 0; i < boxes; ++i) {
      tile_sums[i] = 0;
    }
    const SinCos<float> rotation = sin_cos(tiles[t].theta);
    for (std::uint32_t first = 0; first < params.point_count; first += kBoundBlock) {
      const std::uint32_t in_block = lesser(kBoundBlock, params.point_count - first);
      locate_tiles(params, points + first, in_block, tiles[t], rotation, offsets);
      if (params.tile_width == 2) {
        add_small_tile(field, params.width, offsets, in_block, tile_sums);
        continue;
      }
      for (std::uint32_t j = 0; j < kWideTileRows; ++j) {
        add_wide_row(field + at(params.width, j), offsets, in_block, tile_sums + std::size_t{j} * kWideTile);
      }
    }
  }
}
