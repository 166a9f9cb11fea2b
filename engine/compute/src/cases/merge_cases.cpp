#include "cases/case_builder.hpp"
#include "gdtslam/compute/kernels/gdt_merge.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kCap = 20 * 256;

/// Where the scan's field lies in the global one.
struct Placement {
  CaseSize scan;
  std::uint32_t offset_x;
  std::uint32_t offset_y;
};

/// A field of which a quarter is unknown; values crowd around the thresholds' differences.
std::vector<std::uint16_t> field_values(CaseSize size, std::uint64_t random_seed) {
  std::vector<std::uint16_t> values = noise<std::uint16_t>(size, random_seed);
  Random random(random_seed + 1);
  for (std::uint16_t& value : values) {
    const std::uint64_t kind = random.below(8);
    const std::uint64_t near = 1000 + random.below(600);
    value = static_cast<std::uint16_t>(kind < 2 ? kCap : kind < 6 ? near : value % (kCap + 1));
  }
  return values;
}

void add_merge(std::vector<KernelCaseSource>& list, const Placement& place, MergeRule rule, std::uint32_t threshold,
               std::uint32_t lift, bool benchmark) {
  const std::string name = size_name(place.scan) + " at " + std::to_string(place.offset_x) + "," +
                           std::to_string(place.offset_y) + (rule == MergeRule::kWorking ? " working" : " literal") +
                           " T" + std::to_string(threshold) + " L" + std::to_string(lift);
  add_case<GdtMerge>(
      list, name,
      [=](const std::string& named) {
        const CaseSize scan = place.scan;
        const CaseSize global{scan.width + place.offset_x, scan.height + place.offset_y,
                              grid_stride(scan.width + place.offset_x)};
        const std::uint64_t random_seed = seed_from(named);
        const GdtMerge::Params params{scan.width,     scan.height, scan.stride, global.stride, place.offset_x,
                                      place.offset_y, threshold,   lift,        kCap,          rule};
        return make_case<GdtMerge>(named, params, {scan.width, scan.height, 1},
                                   {grid_buffer(global, field_values(global, random_seed)),
                                    grid_buffer(scan, field_values(scan, random_seed + 2))});
      },
      benchmark);
}

}  // namespace

void add_merge_cases(std::vector<KernelCaseSource>& list) {
  for (const CaseSize& size : kCaseSizes) {
    for (const MergeRule rule : {MergeRule::kWorking, MergeRule::kLiteral}) {
      add_merge(list, {size, 0, 0}, rule, 256, 128, false);
      add_merge(list, {size, 5, 3}, rule, 256, 256, false);
      add_merge(list, {size, 2, 1}, rule, 0, 0, false);
    }
  }
  add_merge(list, {{17, 16, 32}, 3, 0}, MergeRule::kWorking, 70000, 70000, false);
  add_merge(list, {{512, 512, 512}, 37, 41}, MergeRule::kWorking, 256, 128, true);
  add_merge(list, {{512, 512, 512}, 37, 41}, MergeRule::kLiteral, 256, 128, true);
}

}  // namespace gdtslam
