// The steps of pose_cost in plain loops, for any processor.

template <bool kBilinear, bool kSquared>
class BlockSteps {
 public:
  BlockSteps(const CostContext& context, const CostPose& pose) : context_(context), pose_(pose) {}

  /// Fills in positions and cells of the points.
  void locate(const PointCells* points, std::uint32_t count, CostBlock& block) const {
    for (std::uint32_t i = 0; i < count; ++i) {
      const float u = (pose_.c * points[i].x - pose_.s * points[i].y) + pose_.x;
      const float v = (pose_.s * points[i].x + pose_.c * points[i].y) + pose_.y;
      const std::int32_t qx = floor_position(u * 256.0F + 0.5F) + context_.shift_x;
      const std::int32_t qy = floor_position(v * 256.0F + 0.5F) + context_.shift_y;
      block.position_x[i] = qx;
      block.position_y[i] = qy;
      const auto x = static_cast<std::uint32_t>(clamped(qx >> 8, 0, context_.last_x));
      const auto y = static_cast<std::uint32_t>(clamped(qy >> 8, 0, context_.last_y));
      block.cell[i] = field_place(x, y, context_.stride, context_.strip_step);
    }
  }

  void add_values(const CostBlock& block, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t value = lesser(field_value(block, i), context_.cap);
      sum_ += kSquared ? (value * value) >> context_.square_shift : value;
    }
  }

  [[nodiscard]] std::uint32_t sum() const { return sum_; }

 private:
  [[nodiscard]] std::uint32_t field_value(const CostBlock& block, std::uint32_t i) const {
    if constexpr (!kBilinear) {
      return context_.field[block.cell[i]] ^ (context_.blank & 0xFFFFU);
    }
    std::uint32_t lower_pair = 0;
    std::uint32_t upper_pair = 0;
    __builtin_memcpy(&lower_pair, context_.field + block.cell[i], 4);
    __builtin_memcpy(&upper_pair, context_.field + context_.stride + block.cell[i], 4);
    lower_pair ^= context_.blank;
    upper_pair ^= context_.blank;
    const auto fx = static_cast<std::uint32_t>(block.position_x[i] & 255);
    const auto fy = static_cast<std::uint32_t>(block.position_y[i] & 255);
    const std::uint32_t lower = left(lower_pair) * (256 - fx) + right(lower_pair) * fx;
    const std::uint32_t upper = left(upper_pair) * (256 - fx) + right(upper_pair) * fx;
    return (lower * (256 - fy) + upper * fy) >> 16U;
  }
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  static std::uint32_t left(std::uint32_t pair) { return pair >> 16U; }
  static std::uint32_t right(std::uint32_t pair) { return pair & 0xFFFFU; }
#else
  static std::uint32_t left(std::uint32_t pair) { return pair & 0xFFFFU; }
  static std::uint32_t right(std::uint32_t pair) { return pair >> 16U; }
#endif

  const CostContext& context_;
  CostPose pose_;
  std::uint32_t sum_ = 0;
};
