// Cases at random, for those who want more than the list.
#include <algorithm>

#include "case_builder.hpp"

namespace gdtslam {
namespace {

const std::vector<RandomKernel>& random_kernels() {
  static const std::vector<RandomKernel> list = [] {
    std::vector<RandomKernel> kernels;
    add_edt_draws(kernels);
    add_jump_flood_draws(kernels);
    add_field_draws(kernels);
    add_pose_cost_draws(kernels);
    add_merge_draws(kernels);
    add_lattice_draws(kernels);
    add_map_draws(kernels);
    add_pose_simplex_draws(kernels);
    add_choose_pose_draws(kernels);
    add_sweep_points_draws(kernels);
    add_pose_bounds_draws(kernels);
    return kernels;
  }();
  return list;
}

}  // namespace

std::uint32_t draw_count(Random& random, std::uint32_t most) {
  const std::uint64_t bits = random.below(33);
  const std::uint64_t limit = std::min<std::uint64_t>(most, (std::uint64_t{1} << bits) - 1);
  return static_cast<std::uint32_t>(random.below(limit + 1));
}

CaseSize draw_size(Random& random, std::uint32_t least) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kMost[] = {{3, 3},   {20, 20},   {80, 80},   {80, 80},
                                                               {80, 80}, {300, 300}, {2000, 16}, {16, 2000}};
  const auto [most_x, most_y] = draw_from(random, kMost);
  CaseSize size{};
  size.width = least + static_cast<std::uint32_t>(random.below(most_x + 1));
  size.height = least + static_cast<std::uint32_t>(random.below(most_y + 1));
  const auto padding = static_cast<std::uint32_t>(random.below(2) == 0 ? 0 : random.below(10));
  size.stride = (size.width + 3) / 4 * 4 + 4 * padding;
  return size;
}

SeedPattern draw_pattern(Random& random) {
  constexpr SeedPattern kAll[] = {SeedPattern::kNone, SeedPattern::kOne,     SeedPattern::kSparse, SeedPattern::kHalf,
                                  SeedPattern::kAll,  SeedPattern::kCorners, SeedPattern::kChecks, SeedPattern::kWalls};
  return draw_from(random, kAll);
}

KernelCaseSource random_kernel_case(std::uint64_t seed, std::uint32_t index) {
  Random random = Random(seed).split(index);
  const RandomKernel& drawn = random_kernels()[random.below(random_kernels().size())];
  const std::string name = "random " + std::to_string(seed) + "/" + std::to_string(index);
  return {drawn.kernel, name, false, false, [drawn, name, random] {
            Random contents = random;
            return drawn.draw(name, contents);
          }};
}

std::vector<KernelCaseSource> random_kernel_cases(std::uint64_t seed, std::uint32_t count) {
  std::vector<KernelCaseSource> list;
  list.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    list.push_back(random_kernel_case(seed, i));
  }
  return list;
}

}  // namespace gdtslam
