#include <algorithm>

#include "engine/compute/cases/case_builder.hpp"
#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "gdt_stamp.hpp"

namespace gdtslam {
namespace {

/// Positions of a tile's obstacles.
enum class StampSpread : std::uint8_t { kAnywhere, kOutside, kEdges, kOneCell };
constexpr StampSpread kStampSpreads[] = {StampSpread::kAnywhere, StampSpread::kOutside, StampSpread::kEdges,
                                         StampSpread::kOneCell};
constexpr const char* kSpreadNames[] = {"anywhere", "outside", "at edges", "in one cell"};

/// A field in which every second tile is stamped, like a chessboard.
struct StampCase {
  using Kernel = GdtStamp;
  CaseSize field;
  std::uint32_t obstacles = 17;  ///< obstacles of a tile, at most
  std::uint32_t radius = 20;
  MergeRule rule = MergeRule::kWorking;
  std::uint32_t threshold = 256;
  std::uint32_t lift = 128;
  StampSpread spread = StampSpread::kAnywhere;
  bool all_tiles = false;
  bool strips = false;  ///< and the cap is 0

  [[nodiscard]] std::string name() const {
    return size_name(field) + " " + std::to_string(obstacles) + " obstacles " +
           kSpreadNames[static_cast<std::size_t>(spread)] + " R" + std::to_string(radius) +
           (rule == MergeRule::kWorking ? " working" : " literal") + " T" + std::to_string(threshold) + " L" +
           std::to_string(lift) + (all_tiles ? " all" : "") + (strips ? " strips" : "");
  }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

std::uint32_t draw_obstacle(StampSpread spread, std::uint32_t radius, Random& random) {
  const std::uint32_t reach = kStampTile + 2 * radius;  // side of the square from which a disc reaches the tile, cells
  const auto anywhere = [&] { return static_cast<std::uint32_t>(random.below(reach)); };
  const auto beyond = [&] {
    const auto away = static_cast<std::uint32_t>(random.below(radius));
    return random.below(2) == 0 ? away : kStampTile + radius + away;
  };
  const auto at_edge = [&] {
    const std::uint32_t edges[] = {0, radius - 1, radius, radius + 31, radius + 32, radius + kStampTile - 1, reach - 1};
    return draw_from(random, edges);
  };
  switch (spread) {
    case StampSpread::kOutside: {
      const std::uint32_t x = beyond();
      return anywhere() << 16U | x;
    }
    case StampSpread::kEdges: {
      const std::uint32_t x = at_edge();
      return at_edge() << 16U | x;
    }
    case StampSpread::kOneCell:
      return (radius + 13) << 16U | (radius + 40);
    case StampSpread::kAnywhere:
      break;
  }
  const std::uint32_t x = anywhere();
  return anywhere() << 16U | x;
}

/// Known and unknown cells, with many values near the thresholds of the rule.
std::vector<std::uint16_t> map_values(CaseSize size, std::uint32_t cap, std::uint64_t random_seed) {
  std::vector<std::uint16_t> values = noise<std::uint16_t>(size, random_seed);
  Random random(random_seed + 1);
  for (std::uint16_t& value : values) {
    const std::uint64_t kind = random.below(8);
    value = static_cast<std::uint16_t>(kind < 2 ? cap : kind < 6 ? random.below(1500) : value % (cap + 1));
  }
  return values;
}

KernelCase StampCase::make(const std::string& named) const {
  Random random(seed_from(named));
  const FieldLayout layout = strips ? strips_for(field, field_cap(radius)) : FieldLayout{field.stride};
  std::vector<StampTile> tiles;
  std::vector<std::uint32_t> list;
  std::uint32_t most = 0;
  for (std::uint32_t y = 0; y < field.height; y += kStampTile) {
    for (std::uint32_t x = 0; x < field.width; x += kStampTile) {
      if (!all_tiles && (x + y) / kStampTile % 2 != 0) continue;
      const std::uint32_t count = std::max<std::uint32_t>(1, obstacles - draw_count(random, obstacles / 4));
      const std::uint32_t width = std::min(kStampTile, field.width - x);
      const std::uint32_t height = std::min(kStampTile, field.height - y);
      tiles.push_back({static_cast<std::uint32_t>(layout.place(x, y)), height << 16U | width,
                       static_cast<std::uint32_t>(list.size()), count});
      for (std::uint32_t i = 0; i < count; ++i) list.push_back(draw_obstacle(spread, radius, random));
      while (list.size() % kStampGroup != 0) list.push_back(list.back());
      most = std::max(most, count);
    }
  }
  const auto tile_count = static_cast<std::uint32_t>(tiles.size());
  std::vector<std::uint32_t> words;
  for (const StampTile& t : tiles) words.insert(words.end(), {t.base, t.size, 4 * tile_count + t.first, t.count});
  words.insert(words.end(), list.begin(), list.end());
  const GdtStamp::Params params{tile_count,  static_cast<std::uint32_t>(words.size()),
                                most,        layout.stride,
                                radius,      threshold,
                                lift,        field_cap(radius),
                                rule,        layout.strip,
                                layout.blank};
  const std::vector<std::uint16_t> map = map_values(field, field_cap(radius), random.bits());
  return make_case<GdtStamp>(named, params, {tile_count, 1, 1},
                             {strips ? list_buffer(in_strips(field, map, layout)) : grid_buffer(field, map),
                              list_buffer(words), list_buffer(stamp_disc(radius))});
}

KernelCase draw_stamp(const std::string& name, Random& random) {
  StampCase stamp{.field = draw_size(random, 1)};
  stamp.obstacles = 1 + draw_count(random, 300);
  stamp.radius = 1 + draw_count(random, 254);
  stamp.rule = random.below(2) == 0 ? MergeRule::kWorking : MergeRule::kLiteral;
  stamp.threshold = draw_count(random, 70000);
  stamp.lift = draw_count(random, stamp.threshold);
  stamp.spread = draw_from(random, kStampSpreads);
  stamp.all_tiles = random.below(2) == 0;
  stamp.strips = random.below(2) == 0;
  return stamp.make(name);
}

void add_gdt_stamp_cases(std::vector<KernelCaseSource>& list) {
  constexpr std::uint32_t kObstacles[] = {1, 2, 3, 4, 5, 9, 33};
  for (const MergeRule rule : {MergeRule::kWorking, MergeRule::kLiteral}) {
    for_each_size([&](CaseSize size) {
      for (const std::uint32_t radius : kCaseRadii) add_case(list, StampCase{size, 5, radius, rule});
      for (const StampSpread spread : kStampSpreads) {
        add_case(list, StampCase{size, 12, 20, rule, 256, 256, spread, true});
        add_case(list, StampCase{size, 12, 20, rule, 256, 256, spread, true, true});
      }
      add_case(list, StampCase{size, 7, 33, rule, 0, 0, StampSpread::kEdges, true});
    });
    for (const CaseSize& size : kLongSizes) add_case(list, StampCase{size, 9, 31, rule});
  }
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    const std::uint32_t threshold = turn % 5 == 0 ? 0 : 256;
    add_case(list, StampCase{size, in_turn(kObstacles, turn), in_turn(kCaseRadii, turn / 2),
                             turn % 2 == 0 ? MergeRule::kWorking : MergeRule::kLiteral, threshold,
                             threshold / (1 + turn % 2), in_turn(kStampSpreads, turn / 3)});
  });
  add_case(list, StampCase{{64, 64, 64}, 65537, 20});
  add_case(list, StampCase{{65, 64, 96}, 300, 2, MergeRule::kWorking, 70000, 70000, StampSpread::kAnywhere, true});
  for (const CaseSize& size : kLargeSizes) add_case(list, StampCase{size, 3, 20}, CaseUse::kLarge);
  add_case(list, StampCase{{512, 512, 512}, 11, 20, MergeRule::kWorking, 256, 128, StampSpread::kAnywhere, true},
           CaseUse::kBenchmark);
}

}  // namespace

CaseGroup GdtStamp::cases() { return {add_gdt_stamp_cases, {{&GdtStamp::info(), draw_stamp}}}; }

}  // namespace gdtslam
