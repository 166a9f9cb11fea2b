// An affine function below the cost in a box of poses: the sum of one for each point, which lies below the field in the
// box through which the poses move it. Three steps for a block of points: position, look-up, minorant; plain loops that
// become vectors.

constexpr std::uint32_t kMinorantBlock = 256;
constexpr std::uint32_t kMinorantLanes = 16;
constexpr std::uint32_t kPatch = 4;  ///< cells read along x and along y
/// Loss of a point by rounding a cost's term down, and by float32, 1/256 cell.
constexpr float kTermSlack = 1.25F;

struct MinorantBlock {
  alignas(64) float low_x[kMinorantBlock];  ///< box of the point, cells from the centre of its patch's first cell
  alignas(64) float high_x[kMinorantBlock];
  alignas(64) float low_y[kMinorantBlock];
  alignas(64) float high_y[kMinorantBlock];
  alignas(64) float from_x[kMinorantBlock];  ///< the point seen from the robot, turned by the box's angle
  alignas(64) float from_y[kMinorantBlock];
  alignas(64) float slack[kMinorantBlock];          ///< largest deviation of the point from the affine path, cells
  alignas(64) std::int32_t counts[kMinorantBlock];  ///< all bits set if the box fits into the patch, else none
  alignas(64) std::int32_t cell_x[kMinorantBlock];
  alignas(64) std::int32_t cell_y[kMinorantBlock];
  alignas(64) std::uint32_t pairs[kPatch][2 * kMinorantBlock];  ///< two neighbours in a row, then the next two
};

constexpr float absolute(float value) { return value < 0.0F ? -value : value; }
constexpr float lesser(float a, float b) { return a < b ? a : b; }
/// 1/value to some 1e-5 for values from 1e-4 to 1e4: multiplications only, so that devices agree.
inline float about_inverse(float value) {
  std::int32_t bits = 0;
  __builtin_memcpy(&bits, &value, 4);
  bits = 0x7EF311C7 - bits;
  float guess = 0.0F;
  __builtin_memcpy(&guess, &bits, 4);
  guess = guess * (2.0F - value * guess);
  return guess * (2.0F - value * guess);
}

/// Floor of a value within +-2^30.
inline std::int32_t floor_to_int32(float value) {
#if GDTSLAM_ISA_LEVEL > 0
  return static_cast<std::int32_t>(__builtin_floorf(value));  // an instruction
#else
  const auto truncated = static_cast<std::int32_t>(value);
  return truncated - (static_cast<float>(truncated) > value ? 1 : 0);
#endif
}

/// The slope over a box from the total rise of two of its sides.
inline std::int32_t to_slope(float rise, float half) {
  constexpr auto kMost = static_cast<float>(PoseMinorant::kMostSlope);
  float slope = rise * about_inverse(4.0F * half) + 0.5F;
  slope = slope > -kMost ? slope : -kMost;
  slope = slope < kMost ? slope : kMost;
  return floor_to_int32(slope);
}

inline void locate_boxes(const PoseMinorant::Params& params, const PoseCandidate& box, const SinCos<float>& rotation,
                         const PointCells* points, std::uint32_t count, MinorantBlock& block) {
  const float a = params.half_angle;
  const float bend = 0.5F * a * a;
  const float reach = params.half_width + params.slack;
  const float slack = params.slack;
  const float s = rotation.sin;
  const float c = rotation.cos;
  const PoseCandidate centre = box;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float x = c * points[i].x - s * points[i].y;
    const float y = s * points[i].x + c * points[i].y;
    const float far_x = absolute(x);
    const float far_y = absolute(y);
    const float half_x = reach + (far_y * a + far_x * bend);
    const float half_y = reach + (far_x * a + far_y * bend);
    const float u = (x + centre.x) - 0.5F;
    const float v = (y + centre.y) - 0.5F;
    const std::int32_t cell_x = floor_position(u - half_x);
    const std::int32_t cell_y = floor_position(v - half_y);
    block.low_x[i] = (u - half_x) - static_cast<float>(cell_x);
    block.high_x[i] = (u + half_x) - static_cast<float>(cell_x);
    block.low_y[i] = (v - half_y) - static_cast<float>(cell_y);
    block.high_y[i] = (v + half_y) - static_cast<float>(cell_y);
    block.from_x[i] = x;
    block.from_y[i] = y;
    block.slack[i] = slack + bend * (far_x + far_y);
    const bool fits = block.high_x[i] < 3.0F && block.high_y[i] < 3.0F;
    block.counts[i] = fits && far_x + far_y < PoseMinorant::kFarthest ? -1 : 0;
    block.cell_x[i] = cell_x;
    block.cell_y[i] = cell_y;
  }
}

/// Makes a point that does not count.
inline void make_idle(std::uint32_t i, MinorantBlock& block) {
  block.low_x[i] = block.low_y[i] = 0.0F;
  block.high_x[i] = block.high_y[i] = 1.0F;
  block.from_x[i] = block.from_y[i] = block.slack[i] = 0.0F;
  block.counts[i] = 0;
  for (std::uint32_t j = 0; j < kPatch; ++j) {
    block.pairs[j][2 * i] = block.pairs[j][2 * i + 1] = 0;
  }
}

/// Fills a block up to whole vectors with such points: loops without remainders are twice as fast.
inline std::uint32_t fill_up(std::uint32_t count, MinorantBlock& block) {
  const std::uint32_t whole = (count + kMinorantLanes - 1) / kMinorantLanes * kMinorantLanes;
  for (std::uint32_t i = count; i < whole; ++i) {
    make_idle(i, block);
  }
  return whole;
}

/// Reads the patches. Outside the edge counts as the edge's value, the cap.
inline void read_patches(const PoseMinorant::Params& params, const std::uint16_t* field, std::uint32_t count,
                         MinorantBlock& block) {
  const auto width = static_cast<std::int32_t>(params.width);
  const auto height = static_cast<std::int32_t>(params.height);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (block.counts[i] == 0) {
      make_idle(i, block);
      continue;
    }
    const std::int32_t x = block.cell_x[i] + params.anchor_x;
    const std::int32_t y = block.cell_y[i] + params.anchor_y;
    const bool inside = x >= 0 && y >= 0 && x <= width - 4 && y <= height - 4;
    if (inside) {
      const std::uint16_t* cells = field + at(params.stride, static_cast<std::uint32_t>(y)) + x;
      for (std::uint32_t j = 0; j < kPatch; ++j) {
        __builtin_memcpy(&block.pairs[j][2 * i], cells, 8);
        cells += params.stride;
      }
      continue;
    }
    for (std::uint32_t j = 0; j < kPatch; ++j) {
      const std::int32_t row = clamped(y + static_cast<std::int32_t>(j), 0, height - 1);
      const std::uint16_t* cells = field + at(params.stride, static_cast<std::uint32_t>(row));
      std::uint16_t four[kPatch];
      for (std::uint32_t k = 0; k < kPatch; ++k) {
        four[k] = cells[clamped(x + static_cast<std::int32_t>(k), 0, width - 1)];
      }
      __builtin_memcpy(&block.pairs[j][2 * i], four, 8);
    }
  }
}

/// The cells of a patch as numbers.
inline float cell_of_pair(std::uint32_t pair, bool second, std::uint32_t cap) {
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  second = !second;
#endif
  const std::uint32_t value = second ? pair >> 16U : pair & 0xFFFFU;
  return static_cast<float>(static_cast<std::int32_t>(lesser(value, cap)));
}

/// Weight of each of four neighbours at a position relative to the first one, 0 to 3.
inline void hats_at(float place, float (&hats)[kPatch]) {
  for (std::uint32_t k = 0; k < kPatch; ++k) {
    const float off = 1.0F - absolute(place - static_cast<float>(k));
    hats[k] = off > 0.0F ? off : 0.0F;
  }
}
inline float at_hats(const float (&values)[kPatch], const float (&hats)[kPatch]) {
  return (values[0] * hats[0] + values[1] * hats[1]) + (values[2] * hats[2] + values[3] * hats[3]);
}

/// A point's box in its patch: the field in each row at the box's ends and at the cells between them.
struct PatchBox {
  float left[kPatch];
  float right[kPatch];
  float inner[2][kPatch];
  float half_x;
  float half_y;
  float hats_y[kPatch];
};

inline void cut_patch(std::uint32_t cap, const MinorantBlock& block, std::uint32_t i, PatchBox& box) {
  float hats_x[kPatch];
  hats_at(block.high_x[i], hats_x);
  hats_at(block.high_y[i], box.hats_y);
  box.half_x = 0.5F * (block.high_x[i] - block.low_x[i]);
  box.half_y = 0.5F * (block.high_y[i] - block.low_y[i]);
  for (std::uint32_t j = 0; j < kPatch; ++j) {
    const float cells[kPatch] = {
        cell_of_pair(block.pairs[j][2 * i], false, cap), cell_of_pair(block.pairs[j][2 * i], true, cap),
        cell_of_pair(block.pairs[j][2 * i + 1], false, cap), cell_of_pair(block.pairs[j][2 * i + 1], true, cap)};
    box.inner[0][j] = cells[1];
    box.inner[1][j] = cells[2];
    box.left[j] = cells[0] + (cells[1] - cells[0]) * block.low_x[i];
    box.right[j] = at_hats(cells, hats_x);
  }
}

/// Slopes along x and y over the box, from its corners.
struct WholeSlopes {
  std::int32_t x;
  std::int32_t y;
};
inline WholeSlopes slopes_over(const PatchBox& box, float y0) {
  const float low_left = box.left[0] + (box.left[1] - box.left[0]) * y0;
  const float low_right = box.right[0] + (box.right[1] - box.right[0]) * y0;
  const float high_left = at_hats(box.left, box.hats_y);
  const float high_right = at_hats(box.right, box.hats_y);
  return {to_slope((low_right - low_left) + (high_right - high_left), box.half_x),
          to_slope((high_left - low_left) + (high_right - low_right), box.half_y)};
}

/// The least value of the field minus the slopes' rise from the box's middle. In a row of the patch the field is
/// piecewise linear: minus its slope it is least at an end of the box or at a cell in between. The least values of the
/// rows are interpolated along y, where the same holds.
inline float least_over(const PatchBox& box, float gx, float gy, float x0, float x1, float y0, float y1) {
  const float middle_x = x0 + box.half_x;
  const float middle_y = y0 + box.half_y;
  float least[kPatch];
  for (std::uint32_t j = 0; j < kPatch; ++j) {
    const float ends = lesser(box.left[j] + gx * box.half_x, box.right[j] - gx * box.half_x);
    const float first = box.inner[0][j] - gx * (1.0F - middle_x);
    const float second = box.inner[1][j] - gx * (2.0F - middle_x);
    const float with_first = x1 > 1.0F ? lesser(ends, first) : ends;
    least[j] = x1 > 2.0F ? lesser(with_first, second) : with_first;
  }
  const float at_low = (least[0] + (least[1] - least[0]) * y0) + gy * box.half_y;
  const float at_high = at_hats(least, box.hats_y) - gy * box.half_y;
  const float ends = lesser(at_low, at_high);
  const float with_first = y1 > 1.0F ? lesser(ends, least[1] - gy * (1.0F - middle_y)) : ends;
  return y1 > 2.0F ? lesser(with_first, least[2] - gy * (2.0F - middle_y)) : with_first;
}

/// Adds the minorants of a block's points.
inline void add_minorants(std::uint32_t cap, std::uint32_t count, const MinorantBlock& block,
                          PoseMinorant::Value& total) {
  std::int32_t constant = 0;
  std::int32_t slope_x = 0;
  std::int32_t slope_y = 0;
  std::int32_t slope_theta = 0;
  count = count / kMinorantLanes * kMinorantLanes;  // no-op: shows the compiler the multiple
  for (std::uint32_t i = 0; i < count; ++i) {
    PatchBox box;
    cut_patch(cap, block, i, box);
    const WholeSlopes slopes = slopes_over(box, block.low_y[i]);
    const auto gx = static_cast<float>(slopes.x);
    const auto gy = static_cast<float>(slopes.y);
    const float value = least_over(box, gx, gy, block.low_x[i], block.high_x[i], block.low_y[i], block.high_y[i]);
    const float term = value - ((absolute(gx) + absolute(gy)) * block.slack[i] + kTermSlack);
    const float turn = (gy * block.from_x[i] - gx * block.from_y[i]) * (1.0F / PoseMinorant::kThetaStep);
    const std::int32_t counts = block.counts[i];
    constant += floor_to_int32(term) & counts;
    slope_x += slopes.x & counts;
    slope_y += slopes.y & counts;
    slope_theta += floor_to_int32(turn) & counts;
  }
  total.constant += constant;
  total.slope_x += slope_x;
  total.slope_y += slope_y;
  total.slope_theta += slope_theta;
}

void pose_minorant(const PoseMinorant::Params& params, const std::uint16_t* field, const PointCells* points,
                   const PoseCandidate* boxes, std::uint32_t count, PoseMinorant::Value* values) {
  MinorantBlock block;
  for (std::uint32_t b = 0; b < count; ++b) {
    const SinCos<float> rotation = sin_cos(boxes[b].theta);
    PoseMinorant::Value total;
    for (std::uint32_t first = 0; first < params.point_count; first += kMinorantBlock) {
      const std::uint32_t in_block = lesser(kMinorantBlock, params.point_count - first);
      locate_boxes(params, boxes[b], rotation, points + first, in_block, block);
      read_patches(params, field, in_block, block);
      add_minorants(params.cap, fill_up(in_block, block), block, total);
    }
    values[b] = total;
  }
}
