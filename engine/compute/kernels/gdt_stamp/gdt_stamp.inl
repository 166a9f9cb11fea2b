// Stamps discs of distances into a tile, row by row in pieces of fixed length at fixed positions, so that the loops are
// whole vectors; then merges the touched rows.

/// Cells of a row stamped at once.
constexpr std::uint32_t kStampPiece = 32;
static_assert(kStampPiece == kDiscMargin && kStampTile % kStampPiece == 0);

/// The field of a tile's obstacles, and the rows with any.
struct StampedTile {
  alignas(64) std::uint16_t cells[kStampTile * kStampTile];
  std::int32_t first_row;
  std::int32_t end_row;
};

inline void stamp_piece(std::uint16_t* __restrict out, const std::uint16_t* __restrict disc) {
  for (std::uint32_t i = 0; i < kStampPiece; ++i) {
    out[i] = lesser(out[i], disc[i]);
  }
}

void stamp_obstacle(const GdtStamp::Params& params, std::uint32_t obstacle, const std::uint16_t* disc,
                    StampedTile& tile) {
  constexpr auto kSide = static_cast<std::int32_t>(kStampTile);
  constexpr auto kPiece = static_cast<std::int32_t>(kStampPiece);
  const auto radius = static_cast<std::int32_t>(params.radius);
  const std::int32_t x = static_cast<std::int32_t>(obstacle & 0xFFFFU) - radius;
  const std::int32_t y = static_cast<std::int32_t>(obstacle >> 16U) - radius;
  const std::int32_t first_row = clamped(y - radius, 0, kSide);
  const std::int32_t end_row = clamped(y + radius + 1, 0, kSide);
  const std::int32_t first_piece = clamped(x - radius, 0, kSide) / kPiece * kPiece;
  const std::int32_t end = clamped(x + radius + 1, 0, kSide);
  const auto stride = static_cast<std::int32_t>(disc_stride(params.radius));
  for (std::int32_t row = first_row; row < end_row; ++row) {
    const std::int32_t dy = row < y ? y - row : row - y;
    for (std::int32_t piece = first_piece; piece < end; piece += kPiece) {
      stamp_piece(tile.cells + (row * kSide + piece), disc + (dy * stride + radius + kPiece + piece - x));
    }
  }
  tile.first_row = first_row < tile.first_row ? first_row : tile.first_row;
  tile.end_row = end_row > tile.end_row ? end_row : tile.end_row;
}

template <MergeRule kRule>
void stamp_tiles(const GdtStamp::Params& params, std::uint16_t* field, const std::uint32_t* list,
                 const std::uint16_t* disc, Slice slice) {
  const MergeLimits limits = merge_limits(params.threshold, params.lift, params.cap, params.blank);
  const bool has_strips = params.strip != kStripWidth;
  StampedTile stamped;
  for (std::uint32_t t = slice.begin; t < slice.end; ++t) {
    const std::uint32_t* words = list + at(4, t);
    const StampTile tile{words[0], words[1], words[2], words[3]};
    const std::uint32_t width = tile.size & 0xFFFFU;
    const auto height = static_cast<std::int32_t>(tile.size >> 16U);
    stamped.first_row = height;
    stamped.end_row = 0;
    fill_row(stamped.cells, kStampTile * kStampTile, limits.cap);
    for (std::uint32_t i = 0; i < tile.count; ++i) {
      stamp_obstacle(params, list[tile.first + i], disc, stamped);
    }
    const std::int32_t end_row = stamped.end_row < height ? stamped.end_row : height;
    for (std::int32_t row = stamped.first_row; row < end_row; ++row) {
      const auto y = static_cast<std::uint32_t>(row);
      std::uint16_t* out = field + tile.base + at(params.stride, y);
      const std::uint16_t* in = stamped.cells + at(kStampTile, y);
      width == kStampTile ? merge_row<kRule>(limits, out, in, kStampTile) : merge_row<kRule>(limits, out, in, width);
      if (has_strips && tile.base >= params.strip) {
        repeat_before(out, params.strip);
      }
    }
  }
}

void gdt_stamp(const GdtStamp::Params& params, std::uint16_t* field, const std::uint32_t* list,
               const std::uint16_t* disc, Slice slice) {
  params.rule == MergeRule::kWorking ? stamp_tiles<MergeRule::kWorking>(params, field, list, disc, slice)
                                     : stamp_tiles<MergeRule::kLiteral>(params, field, list, disc, slice);
}
