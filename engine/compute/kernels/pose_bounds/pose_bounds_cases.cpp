#include <cmath>
#include <limits>

#include "engine/compute/cases/case_builder.hpp"
#include "engine/compute/cases/scan_data.hpp"
#include "pose_bounds.hpp"

namespace gdtslam {
namespace {

enum class TileShape : std::uint8_t { kSmall, kWide };
/// kHigh: all samples are 255. kOdd: some points are NaN, far off or without a field. kSubnormal: coordinates of many
/// points and tiles are subnormal.
enum class BoundData : std::uint8_t { kPlain, kHigh, kOdd, kSubnormal };

/// Parameters that the cases vary.
struct BoundCase {
  using Kernel = PoseBounds;
  std::uint32_t width = 0;  ///< width of a plane
  std::uint32_t height = 0;
  TileShape shape = TileShape::kWide;
  std::uint32_t points = 0;
  std::uint32_t tiles = 0;
  std::uint32_t phase_bits = 2;
  std::int32_t sample_bits = 1;  ///< a sample is 2^sample_bits cells
  double spread_cells = 40.0;    ///< distance of points and tiles from the field's middle
  BoundData data = BoundData::kPlain;
  std::int32_t shift = 0;  ///< shift of the anchor, out of the field's middle

  [[nodiscard]] std::string name() const {
    constexpr const char* kData[] = {"", " high", " odd", " subnormal"};
    return std::to_string(width) + "x" + std::to_string(height) + (shape == TileShape::kWide ? " wide " : " small ") +
           std::to_string(tiles) + " tiles " + std::to_string(points) + " points phases " +
           std::to_string(1U << phase_bits) + " sample " + std::to_string(sample_bits) + " within " +
           std::to_string(static_cast<int>(spread_cells)) + kData[static_cast<std::size_t>(data)] +
           (shift != 0 ? " anchor " + std::to_string(shift) : "");
  }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

/// Dilated fields for points at growing ranges; their size is mostly not a whole number of words.
constexpr std::uint32_t kDilations = 3;

PoseBounds::Params bound_params(const BoundCase& shape) {
  const bool wide = shape.shape == TileShape::kWide;
  const std::uint32_t dilation = (shape.width * shape.height) << (2 * shape.phase_bits);
  return {.width = shape.width,
          .height = shape.height,
          .first_column = static_cast<std::int32_t>(shape.width / 2) + shape.shift,
          .first_row = static_cast<std::int32_t>(shape.height / 2) - shape.shift,
          .phase_bits = shape.phase_bits,
          .samples_per_cell = std::ldexp(1.0F, -shape.sample_bits),
          .point_count = shape.points,
          .last_field = (kDilations - 1) * dilation,
          .tile_width = wide ? 16U : 2U,
          .tile_height = wide ? 4U : 2U};
}

/// Points, of which the farther ones use later dilations; every seventh lies on a border of samples.
std::vector<BoundPoint> bound_points(const BoundCase& shape, const PoseBounds::Params& params, Random& random) {
  std::vector<BoundPoint> points(shape.points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto dilation = static_cast<std::uint32_t>(random.below(kDilations));
    points[i] = {draw_real(random, shape.spread_cells), draw_real(random, shape.spread_cells),
                 dilation * (params.last_field / (kDilations - 1))};
    if (i % 7 == 3) {
      points[i].x = static_cast<float>(static_cast<int>(points[i].x));
      points[i].y = static_cast<float>(static_cast<int>(points[i].y)) + 0.5F;
    }
  }
  return points;
}

/// Tiles around the anchor; some without rotation on whole cells, some far off.
std::vector<PoseCandidate> bound_tiles(const BoundCase& shape, Random& random) {
  std::vector<PoseCandidate> tiles(shape.tiles);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    tiles[i] = {draw_real(random, shape.spread_cells), draw_real(random, shape.spread_cells), draw_real(random, 3.2),
                static_cast<std::uint32_t>(random.below(1000))};
    if (i % 16 == 3) {
      tiles[i] = {2.0F, -1.5F, 0.0F, 9};
    } else if (i % 16 == 5) {
      tiles[i] = {-1.0e9F, 3.0e30F, 60.0F, 1};
    }
  }
  return tiles;
}

void spoil(std::vector<BoundPoint>& points) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr BoundPoint kOdd[] = {{kNaN, 0.0F, 0},           {1.0F, kNaN, 0xFFFFFFFFU},  {kInfinity, 2.0F, 1},
                                 {0.0F, -kInfinity, 0},     {3.0e38F, 1.0F, 0},         {1.0F, -3.0e38F, 2},
                                 {1.0e9F, -1.0e9F, 0},      {0.0F, -4194304.0F, 0},     {4194303.5F, 9.0F, 3},
                                 {3.0F, 4.0F, 0x80000000U}, {-2.0F, 7.25F, 0xFFFFFFF0U}};
  for (std::size_t i = 1; i < points.size(); i += 2) {
    points[i] = kOdd[i / 2 % std::size(kOdd)];
  }
}

/// Makes coordinates subnormal, in all combinations and with both signs.
void make_subnormal(std::vector<BoundPoint>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float value = i % 2 == 0 ? kSubnormal : -kSubnormal;
    points[i].x = i % 5 < 3 ? value : points[i].x;
    points[i].y = i % 5 > 1 ? -value : points[i].y;
  }
}

KernelCase BoundCase::make(const std::string& named) const {
  Random random(seed_from(named));
  const PoseBounds::Params params = bound_params(*this);
  const std::uint32_t samples = params.last_field / (kDilations - 1) * kDilations;
  const std::uint32_t room = (samples + 3) / 4 * 4;
  std::vector<std::uint8_t> field = noise<std::uint8_t>({samples, 1, room}, random.bits());
  if (data == BoundData::kHigh) {
    field.assign(field.size(), 255);
  }
  std::vector<BoundPoint> scan = bound_points(*this, params, random);
  std::vector<PoseCandidate> tried = bound_tiles(*this, random);
  if (data == BoundData::kOdd) {
    spoil(scan);
  } else if (data == BoundData::kSubnormal) {
    make_subnormal(scan);
    make_subnormal(tried);
  }
  const std::uint32_t sums = tiles * params.tile_width * params.tile_height;
  return make_case<PoseBounds>(named, params, {tiles, 1, 1},
                               {grid_buffer(CaseSize{samples, 1, room}, field), words_buffer(scan), list_buffer(tried),
                                noise_buffer(sums, random)});
}

constexpr TileShape kShapes[] = {TileShape::kSmall, TileShape::kWide};
constexpr BoundData kAllData[] = {BoundData::kPlain, BoundData::kHigh, BoundData::kOdd, BoundData::kSubnormal};

void add_shape(std::vector<KernelCaseSource>& list, TileShape shape) {
  // Below, at and beyond vectors, blocks of 128 and 256 points, work groups and a uniform buffer.
  constexpr std::pair<std::uint32_t, std::uint32_t> kCounts[] = {
      {0, 3},   {1, 1},   {2, 2},   {3, 4},   {4, 7},    {5, 8},   {7, 9},   {15, 15},  {16, 17},  {63, 33},
      {127, 3}, {128, 5}, {129, 6}, {255, 3}, {256, 70}, {257, 2}, {361, 9}, {1365, 2}, {1366, 3}, {2101, 20}};
  std::uint32_t turn = 0;
  for (const auto& [points, tiles] : kCounts) {
    const std::uint32_t phase_bits = turn % 4;
    const std::int32_t sample_bits = static_cast<std::int32_t>(turn % 5) - 1;
    add_case(list, BoundCase{97, 83, shape, points, tiles, phase_bits, sample_bits, 60.0, in_turn(kAllData, turn / 5)});
    add_case(list, BoundCase{46, 51, shape, points, tiles, 2, 0, 25.0});
    ++turn;
  }
  for (std::uint32_t phase_bits = 0; phase_bits <= 4; ++phase_bits) {
    for (std::int32_t sample_bits = -2; sample_bits <= 3; ++sample_bits) {
      const BoundData data = in_turn(kAllData, turn++);
      add_case(list, BoundCase{33, 29, shape, 90, 19, phase_bits, sample_bits, 30.0, data});
    }
  }
  for (const BoundData data : kAllData) {
    add_case(list, BoundCase{17, 19, shape, 300, 40, 1, 0, 12.0, data});
    add_case(list, BoundCase{40, 31, shape, 65, 12, 2, 1, 2000.0, data});  // most points off the field
  }
  add_case(list, BoundCase{23, 21, shape, 65537, 2, 1, 0, 15.0, BoundData::kHigh});
  add_case(list, BoundCase{23, 21, shape, 65537, 3, 1, 0, 15.0});
  for (const std::int32_t shift : {-(1 << 20), 1 << 20, -30, 30}) {
    add_case(list, BoundCase{64, 60, shape, 9, 5, 2, 1, 60.0, BoundData::kPlain, shift});
  }
  add_case(list, BoundCase{64, 60, shape, 5, 70001, 2, 1, 60.0});  // more groups than one row holds
}

KernelCase draw_bounds(const std::string& name, Random& random) {
  BoundCase shape;
  shape.shape = draw_from(random, kShapes);
  const CaseSize size = draw_size(random, shape.shape == TileShape::kWide ? 16 : 2);
  shape.width = size.width;
  shape.height = size.height;
  shape.points = draw_count(random, 500);
  shape.tiles = draw_count(random, 60);
  shape.phase_bits = static_cast<std::uint32_t>(random.below(4));
  shape.sample_bits = static_cast<std::int32_t>(random.below(6)) - 2;
  shape.spread_cells = random.uniform(0.0, 200.0);
  shape.shift = static_cast<std::int32_t>(draw_count(random, 1000)) - 20;
  shape.data = random.below(3) == 0 ? draw_from(random, kAllData) : BoundData::kPlain;
  return shape.make(name);
}

void add_pose_bounds_cases(std::vector<KernelCaseSource>& list) {
  for (const TileShape shape : kShapes) {
    add_shape(list, shape);
  }
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    if (size.width >= 2 && size.height >= 2) {
      add_case(list, BoundCase{size.width, size.height, TileShape::kSmall, turn % 41, turn % 6, turn % 3, 0, 9.0});
    }
    if (size.height >= 4) {
      add_case(list, BoundCase{16 + size.width, size.height, TileShape::kWide, turn % 41, turn % 6, turn % 3, 1, 19.0});
    }
  });
  // Launches of real searches: a whole map's first boxes of 8 cells, and a box's children.
  add_case(list, BoundCase{182, 182, TileShape::kWide, 361, 2344, 2, 1, 300.0}, CaseUse::kBenchmark);
  add_case(list, BoundCase{632, 632, TileShape::kSmall, 361, 4096, 1, 0, 300.0}, CaseUse::kBenchmark);
  add_case(list, BoundCase{632, 632, TileShape::kSmall, 361, 2, 1, 0, 300.0}, CaseUse::kBenchmark);
}

}  // namespace

CaseGroup PoseBounds::cases() { return {add_pose_bounds_cases, {{&PoseBounds::info(), draw_bounds}}}; }

}  // namespace gdtslam
