// The steps of pose_cost in vectors; lanes_*.inl defines the lanes.

template <bool kBilinear, bool kSquared>
class BlockSteps {
 public:
  BlockSteps(const CostContext& context, const CostPose& pose)
      : context_(context),
        s_(all(pose.s)),
        c_(all(pose.c)),
        x_(all(pose.x)),
        y_(all(pose.y)),
        shift_x_(all(context.shift_x)),
        shift_y_(all(context.shift_y)),
        last_x_(all(context.last_x)),
        last_y_(all(context.last_y)),
        stride_(all(static_cast<std::int32_t>(context.stride))),
        strip_step_(all(static_cast<std::int32_t>(context.strip_step))),
        cap_(all(static_cast<std::int32_t>(context.cap))),
        blank_(all(static_cast<std::int32_t>(kBilinear ? context.blank ^ 0x80008000U : context.blank & 0xFFFFU))),
        square_shift_(_mm_cvtsi32_si128(static_cast<int>(context.square_shift))) {}

  /// Fills in positions and cells of the points, in whole vectors.
  void locate(const PointCells* points, std::uint32_t count, CostBlock& block) const {
    std::uint32_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
      locate_lanes(load_points(points + i), block, i);
    }
    if (i < count) {
      locate_lanes(load_points(points + i, count - i), block, i);
    }
  }

  void add_values(const CostBlock& block, std::uint32_t count) {
    std::uint32_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
      sums_ = add(sums_, terms(block, i));
    }
    if (i < count) {
      sums_ = add(sums_, only_first(terms(block, i), count - i));
    }
  }

  [[nodiscard]] std::uint32_t sum() const { return lane_sum(sums_); }

#if GDTSLAM_ISA_LEVEL == 2
  /// Adds the values for candidates with the same theta and y and an x 0 to 30 cells above that of the located points,
  /// one per lane, on a field in strips. A point's cells and their neighbours then span at most 33 columns and lie in
  /// two successive halves of strips. A permutation of these replaces the single loads.
  void add_row_values(const CostBlock& block, std::uint32_t count, Floats x) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Ints qx = add(fixed_point_position(add(all(block.turned_x[i]), x)), shift_x_);
      const Ints columns = clamped_cell(qx, last_x_);
      const std::int32_t first = _mm_cvtsi128_si32(_mm512_castsi512_si128(columns));
      const std::int32_t in_strip = first & 63;
      const std::uint16_t* high = context_.field + block.cell[i] + (32 - in_strip);
      const bool is_next_in_field = in_strip >= 32 && (first | 63) <= context_.last_x;
      const std::uint16_t* low = high - 32 + (is_next_in_field ? kStripWidth + context_.strip_step : 0);
      const Ints lower = pick_cells<kBilinear>(low, high, columns);
      const Ints upper = pick_cells<kBilinear>(low + context_.stride, high + context_.stride, columns);
      sums_ = add(sums_, terms(lower, upper, qx, all(block.position_y[i])));
    }
  }
  [[nodiscard]] Ints sums() const { return sums_; }
#endif

 private:
  void locate_lanes(const LanePoints& p, CostBlock& block, std::uint32_t i) const {
    const Floats turned_x = sub(mul(c_, p.x), mul(s_, p.y));
    const Floats v = add(add(mul(s_, p.x), mul(c_, p.y)), y_);
    const Ints qx = add(fixed_point_position(add(turned_x, x_)), shift_x_);
    const Ints qy = add(fixed_point_position(v), shift_y_);
    const Ints x = clamped_cell(qx, last_x_);
    const Ints in_strip = add(mul(clamped_cell(qy, last_y_), stride_), x);
    static_assert(kStripWidth == 1U << 6U);
    store(block.cell + i, add(in_strip, mul(shift_right_signed<6>(x), strip_step_)));
    store(block.turned_x + i, bits_of(turned_x));
    if constexpr (kBilinear) {
      store(block.position_x + i, qx);
      store(block.position_y + i, qy);
    }
  }

  static Ints fixed_point_position(Floats coordinate) {
    const Floats scaled = add(mul(coordinate, all(256.0F)), all(0.5F));
    return floor_to_int(lesser(greater(scaled, all(-kFarthestPosition)), all(kFarthestPosition)));
  }

  static Ints clamped_cell(Ints position, Ints last) {
    return lesser(greater(shift_right_signed<8>(position), all(0)), last);
  }

  [[nodiscard]] Ints terms(const CostBlock& block, std::uint32_t i) const {
    const Ints lower = load_pairs(context_.field, block.cell + i);
    const Ints upper = kBilinear ? load_pairs(context_.field + context_.stride, block.cell + i) : lower;
    return terms(lower, upper, load(block.position_x + i), load(block.position_y + i));
  }

  /// Terms from two pairs of neighbours, or from the left cell of `lower` for the nearest.
  [[nodiscard]] Ints terms(Ints lower, Ints upper, Ints qx, Ints qy) const {
    Ints value = either(lower, blank_);
    value = kBilinear ? between_four(value, either(upper, blank_), qx, qy) : both(value, all(0xFFFF));
    value = lesser(value, cap_);
    if constexpr (kSquared) {
      value = shift_right(mul(value, value), square_shift_);
    }
    return value;
  }

  /// Bilinear value from two pairs of neighbours. Their top bits are flipped, which makes them signed, so that one
  /// instruction multiplies and adds both halves. That makes sums too small by 2^15 times the weights, 2^31 in the end;
  /// flipping the top bit corrects it. The flip and the field's blank are one operation.
  static Ints between_four(Ints lower_pair, Ints upper_pair, Ints qx, Ints qy) {
    const Ints fx = both(qx, all(255));
    const Ints fy = both(qy, all(255));
    const Ints weights = add(shift_left<16>(fx), sub(all(256), fx));
    const Ints lower = dot_halves(lower_pair, weights);
    const Ints upper = dot_halves(upper_pair, weights);
    const Ints sum = add(shift_left<8>(lower), mul(sub(upper, lower), fy));
    return shift_right(either(sum, all(static_cast<std::int32_t>(0x80000000U))), _mm_cvtsi32_si128(16));
  }

  const CostContext& context_;
  Floats s_, c_, x_, y_;
  Ints shift_x_, shift_y_, last_x_, last_y_, stride_, strip_step_, cap_, blank_;
  __m128i square_shift_;
  Ints sums_ = all(0);
};
