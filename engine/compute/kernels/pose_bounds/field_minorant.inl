// Affine minorants of a field around each of its cells. Blocks of a row are gathered with their surroundings first, so
// that loops run over whole vectors; unknown blocks are detected early, since most of a map is unknown.

constexpr std::uint32_t kFieldBlock = 64;
constexpr std::uint32_t kFieldMargin = FieldMinorant::kMargin;
constexpr std::uint32_t kFieldRows = 2 * kFieldMargin - 1;  ///< most rows of a square
constexpr std::uint32_t kGathered = kFieldBlock + 2 * kFieldMargin;

constexpr std::int32_t lesser(std::int32_t a, std::int32_t b) { return a < b ? a : b; }

/// Copies a block with its surroundings; returns false if all of it is the cap.
inline bool gather_block(const FieldMinorant::Params& params, const std::uint16_t* field, std::int32_t column,
                         std::int32_t row, std::int32_t (*around)[kGathered]) {
  const auto reach = static_cast<std::int32_t>(params.reach);
  const auto cap = static_cast<std::int32_t>(params.cap);
  std::int32_t least = cap;
  for (std::int32_t j = -reach; j <= reach; ++j) {
    std::int32_t* to = around[j + reach];
    const std::int32_t y = row + j;
    const bool in_rows = y >= 0 && y < static_cast<std::int32_t>(params.height);
    const std::int32_t first = column - static_cast<std::int32_t>(kFieldMargin);
    for (std::uint32_t k = 0; k < kGathered; ++k) {
      const std::int32_t x = first + static_cast<std::int32_t>(k);
      const bool inside = in_rows && x >= 0 && x < static_cast<std::int32_t>(params.width);
      to[k] = inside
                  ? lesser(static_cast<std::int32_t>(
                               field[at(params.stride, static_cast<std::uint32_t>(y)) + static_cast<std::uint32_t>(x)]),
                           cap)
                  : cap;
      least = lesser(least, to[k]);
    }
  }
  return least < cap;
}

/// Minorants of a block's cells; `reach` is constant so that the loops over a square unroll.
template <std::int32_t kReach>
void block_minorants(const std::int32_t (*around)[kGathered], std::int32_t unit, std::uint32_t* out) {
  constexpr std::int32_t kUnit = FieldMinorant::kSlopeUnit;
  constexpr auto kMiddle = static_cast<std::int32_t>(kFieldMargin);
  constexpr float kPerStep = 1.0F / static_cast<float>(6 * kReach * kUnit);
  std::int32_t slopes_x[kFieldBlock];
  std::int32_t slopes_y[kFieldBlock];
  std::int32_t least[kFieldBlock];
  for (std::uint32_t k = 0; k < kFieldBlock; ++k) {
    const std::int32_t* low = around[0] + k + kMiddle;
    const std::int32_t* mid = around[kReach] + k + kMiddle;
    const std::int32_t* high = around[2 * kReach] + k + kMiddle;
    const std::int32_t rise_x =
        (low[kReach] - low[-kReach]) + (mid[kReach] - mid[-kReach]) + (high[kReach] - high[-kReach]);
    const std::int32_t rise_y = (high[-kReach] - low[-kReach]) + (high[0] - low[0]) + (high[kReach] - low[kReach]);
    slopes_x[k] = clamped(static_cast<std::int32_t>(static_cast<float>(rise_x) * kPerStep), -127, 127);
    slopes_y[k] = clamped(static_cast<std::int32_t>(static_cast<float>(rise_y) * kPerStep), -127, 127);
    least[k] = 0x7FFFFFFF;
  }
  for (std::int32_t j = -kReach; j <= kReach; ++j) {
    for (std::int32_t i = -kReach; i <= kReach; ++i) {
      const std::int32_t* cells = around[j + kReach] + kMiddle + i;
      for (std::uint32_t k = 0; k < kFieldBlock; ++k) {
        least[k] = lesser(least[k], cells[k] - kUnit * (slopes_x[k] * i + slopes_y[k] * j));
      }
    }
  }
  for (std::uint32_t k = 0; k < kFieldBlock; ++k) {
    // Rounded down: the least is above -2^20.
    const std::int32_t raised = clamped(least[k], -32767 * unit, 32767 * unit) + 32768 * unit;
    const std::int32_t constant =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(raised) / static_cast<std::uint32_t>(unit)) - 32768;
    out[k] = (static_cast<std::uint32_t>(constant) & 0xFFFFU) |
             (static_cast<std::uint32_t>(slopes_x[k]) & 0xFFU) << 16U | static_cast<std::uint32_t>(slopes_y[k]) << 24U;
  }
}

void field_minorant(const FieldMinorant::Params& params, const std::uint16_t* field, std::uint32_t* minorants) {
  const std::uint32_t width = params.width + 2 * kFieldMargin;
  const auto unit = static_cast<std::int32_t>(params.constant_unit);
  const std::uint32_t nothing = params.cap / params.constant_unit;
  std::int32_t around[kFieldRows][kGathered];
  std::uint32_t block[kFieldBlock];
  for (std::uint32_t row = 0; row < params.height + 2 * kFieldMargin; ++row) {
    for (std::uint32_t column = 0; column < width; column += kFieldBlock) {
      const std::uint32_t count = lesser(kFieldBlock, width - column);
      std::uint32_t* to = minorants + at(width, row) + column;
      const auto x = static_cast<std::int32_t>(column) - static_cast<std::int32_t>(kFieldMargin);
      const auto y = static_cast<std::int32_t>(row) - static_cast<std::int32_t>(kFieldMargin);
      if (!gather_block(params, field, x, y, around)) {
        for (std::uint32_t k = 0; k < count; ++k) {
          to[k] = nothing;
        }
        continue;
      }
      if (params.reach == 1) {
        block_minorants<1>(around, unit, block);
      } else if (params.reach == 2) {
        block_minorants<2>(around, unit, block);
      } else {
        block_minorants<3>(around, unit, block);
      }
      for (std::uint32_t k = 0; k < count; ++k) {
        to[k] = block[k];
      }
    }
  }
}
