// The steps of pose_cost in vectors; lanes_*.inl defines the lanes.

template <bool kBilinear, bool kSquared>
class BlockSteps {
 public:
  BlockSteps(const CostContext& context, const CostPose& pose)
      : s_(all(pose.s)),
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

  /// Fills in positions and cells of the points; returns how many cells there are to look up, whole vectors.
  std::uint32_t locate(const PointCells* points, std::uint32_t count, CostBlock& block) const {
    std::uint32_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
      locate_lanes(load_points(points + i), block, i);
    }
    if (i < count) {
      locate_lanes(load_points(points + i, count - i), block, i);
      i += kLanes;
    }
    return i;
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

 private:
  void locate_lanes(const LanePoints& p, CostBlock& block, std::uint32_t i) const {
    const Floats u = add(sub(mul(c_, p.x), mul(s_, p.y)), x_);
    const Floats v = add(add(mul(s_, p.x), mul(c_, p.y)), y_);
    const Ints qx = add(fixed_point_position(u), shift_x_);
    const Ints qy = add(fixed_point_position(v), shift_y_);
    const Ints x = clamped_cell(qx, last_x_);
    const Ints in_strip = add(mul(clamped_cell(qy, last_y_), stride_), x);
    static_assert(kStripWidth == 1U << 6U);
    store(block.cell + i, add(in_strip, mul(shift_right_signed<6>(x), strip_step_)));
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
    Ints value = either(load(block.lower + i), blank_);
    if constexpr (kBilinear) {
      value = between_four(value, either(load(block.upper + i), blank_), load(block.position_x + i), load(block.position_y + i));
    }
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

  Floats s_, c_, x_, y_;
  Ints shift_x_, shift_y_, last_x_, last_y_, stride_, strip_step_, cap_, blank_;
  __m128i square_shift_;
  Ints sums_ = all(0);
};
