#include "engine/compute/cases/case_builder.hpp"
#include "gdt_merge.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kCap = 20 * 256;

/// Position of the scan's field in the global one, and the rule.
struct MergeCase {
  using Kernel = GdtMerge;
  CaseSize scan;
  std::uint32_t offset_x = 0;
  std::uint32_t offset_y = 0;
  MergeRule rule = MergeRule::kWorking;
  std::uint32_t threshold = 256;
  std::uint32_t lift = 128;
  std::uint32_t cap = kCap;
  bool strips = false;  ///< the global field lies in strips, with a cap of 0

  [[nodiscard]] std::string name() const {
    return size_name(scan) + " at " + std::to_string(offset_x) + "," + std::to_string(offset_y) +
           (rule == MergeRule::kWorking ? " working" : " literal") + " T" + std::to_string(threshold) + " L" +
           std::to_string(lift) + (cap == kCap ? "" : " cap " + std::to_string(cap)) + (strips ? " strips" : "");
  }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

/// A field with a quarter of its cells unknown. Half of the values are so close that the thresholds matter.
std::vector<std::uint16_t> field_values(CaseSize size, std::uint32_t cap, std::uint64_t random_seed) {
  std::vector<std::uint16_t> values = noise<std::uint16_t>(size, random_seed);
  Random random(random_seed + 1);
  for (std::uint16_t& value : values) {
    const std::uint64_t kind = random.below(8);
    const std::uint64_t near = 1000 + random.below(600);
    value = static_cast<std::uint16_t>(kind < 2 ? cap : kind < 6 ? near : value % (cap + 1));
  }
  return values;
}

KernelCase MergeCase::make(const std::string& named) const {
  constexpr std::uint32_t kBeyond = 3;  // cells of the global field beyond the window, which must not change
  const std::uint32_t width = offset_x + scan.width + kBeyond;
  const CaseSize global{width, offset_y + scan.height + kBeyond, grid_stride(width)};
  const std::uint64_t random_seed = seed_from(named);
  const FieldLayout layout = strips ? strips_for(global, cap) : FieldLayout{global.stride};
  const GdtMerge::Params params{scan.width, scan.height, scan.stride, layout.stride, offset_x,     offset_y,
                                threshold,  lift,        cap,         rule,          layout.strip, layout.blank};
  const std::vector<std::uint16_t> map = field_values(global, cap, random_seed);
  return make_case<GdtMerge>(named, params, {scan.width, scan.height, 1},
                             {strips ? list_buffer(in_strips(global, map, layout)) : grid_buffer(global, map),
                              grid_buffer(scan, field_values(scan, cap, random_seed + 2))});
}

KernelCase draw_merge(const std::string& name, Random& random) {
  MergeCase merge{.scan = draw_size(random)};
  merge.offset_x = draw_count(random, 100);
  merge.offset_y = draw_count(random, 100);
  merge.rule = random.below(2) == 0 ? MergeRule::kWorking : MergeRule::kLiteral;
  merge.threshold = draw_count(random, 70000);
  merge.lift = draw_count(random, merge.threshold);
  merge.strips = random.below(2) == 0;
  merge.cap = random.below(4) == 0 ? draw_count(random, 65535) : kCap;
  return merge.make(name);
}

/// A field and the margins of the new one around it.
struct GrowCase {
  using Kernel = FieldGrow;
  CaseSize old_size;
  std::uint32_t left = 0;
  std::uint32_t below = 0;
  std::uint32_t right = 0;
  std::uint32_t above = 0;
  std::uint32_t cap = 5120;

  [[nodiscard]] CaseSize size() const {
    const std::uint32_t width = left + old_size.width + right;
    return {width, below + old_size.height + above, grid_stride(width)};
  }
  [[nodiscard]] std::string name() const {
    return size_name(old_size) + " to " + size_name(size()) + " at " + std::to_string(left) + "," +
           std::to_string(below);
  }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

KernelCase GrowCase::make(const std::string& named) const {
  const CaseSize grown = size();
  const std::uint64_t random_seed = seed_from(named);
  const FieldGrow::Params params{
      old_size.width, old_size.height, old_size.stride, grown.width, grown.height, grown.stride, left, below, cap};
  return make_case<FieldGrow>(named, params, {grown.width, grown.height, 1},
                              {grid_buffer(old_size, noise<std::uint16_t>(old_size, random_seed)),
                               grid_buffer(grown, noise<std::uint16_t>(grown, random_seed + 1))});
}

KernelCase draw_grow(const std::string& name, Random& random) {
  GrowCase grow{.old_size = draw_size(random)};
  grow.left = draw_count(random, 80);
  grow.below = draw_count(random, 80);
  grow.right = draw_count(random, 80);
  grow.above = draw_count(random, 80);
  grow.cap = draw_count(random, 65535);
  return grow.make(name);
}

void add_grows(std::vector<KernelCaseSource>& list) {
  for_each_size([&](CaseSize size) {
    add_case(list, GrowCase{size});
    add_case(list, GrowCase{size, 1});
    add_case(list, GrowCase{size, 3, 5, 2, 1, 65535});
    add_case(list, GrowCase{size, 32, 2, 7, 0, 0});
    add_case(list, GrowCase{size, 0, 1, 64, 33});
  });
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    add_case(list, GrowCase{size, turn % 3, turn % 2, turn / 2 % 5, turn / 3 % 2, 100 * turn});
  });
  for (const CaseSize& size : kLongSizes) {
    add_case(list, GrowCase{size, 3, 2, 1, 4});
  }
  add_case(list, GrowCase{{4096, 1, 4096}, 3, 0, 5, 0});  // one row, which is cut along its length
  for (const CaseSize& size : kLargeSizes) {
    add_case(list, GrowCase{size, 33, 1, 0, 2}, CaseUse::kLarge);
  }
  add_case(list, GrowCase{{1024, 1024, 1024}, 128, 128, 128, 128}, CaseUse::kBenchmark);
}

void add_gdt_merge_cases(std::vector<KernelCaseSource>& list) {
  for (const MergeRule rule : {MergeRule::kWorking, MergeRule::kLiteral}) {
    for_each_size([&](CaseSize size) {
      add_case(list, MergeCase{size, 0, 0, rule});
      add_case(list, MergeCase{size, 5, 3, rule, 256, 256});
      add_case(list, MergeCase{size, 2, 1, rule, 0, 0});
      for (const std::uint32_t offset : {0U, 3U, 62U, 63U, 64U, 130U}) {
        add_case(list, MergeCase{size, offset, 5, rule, 256, 128, kCap, true});
      }
    });
    for_each_small_size([&](CaseSize size, std::uint32_t turn) {
      const std::uint32_t threshold = turn % 5 == 0 ? 0 : 256;
      add_case(list, MergeCase{size, turn % 3, turn / 3 % 4, rule, threshold, threshold / (1 + turn % 2)});
    });
    for (const CaseSize& size : kLongSizes) {
      add_case(list, MergeCase{size, 1, 1, rule});
    }
  }
  add_case(list, MergeCase{{17, 16, 32}, 3, 0, MergeRule::kWorking, 70000, 70000});
  add_case(list, MergeCase{{31, 5, 32}, 4001, 2});  // far from the left edge, in groups of any size
  add_case(list, MergeCase{{33, 16, 36}, 1, 2, MergeRule::kLiteral, 300, 200, 65535});
  add_case(list, MergeCase{{33, 16, 36}, 1, 2, MergeRule::kWorking, 300, 200, 0});
  for (const CaseSize& size : kLargeSizes) {
    add_case(list, MergeCase{size, 3, 1}, CaseUse::kLarge);
  }
  add_case(list, MergeCase{{512, 512, 512}, 37, 41, MergeRule::kWorking}, CaseUse::kBenchmark);
  add_case(list, MergeCase{{512, 512, 512}, 37, 41, MergeRule::kLiteral}, CaseUse::kBenchmark);
  add_grows(list);
}

}  // namespace

CaseGroup GdtMerge::cases() {
  return {add_gdt_merge_cases, {{&GdtMerge::info(), draw_merge}, {&FieldGrow::info(), draw_grow}}};
}

}  // namespace gdtslam
