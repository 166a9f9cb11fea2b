#include "engine/compute/cases/case_builder.hpp"
#include "jump_flood.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kSteps[] = {1, 2, 16, 128};

/// A state of the flood: seeds know themselves, a quarter of the other cells the latest seed before them, a quarter any
/// of the first 64, so that among equally far seeds the first one that is offered is not always the one of lower index.
std::vector<std::uint32_t> half_flooded(SeedPattern pattern, CaseSize size, const std::string& name) {
  const std::vector<std::uint8_t> seeds = seeds_for(pattern, size, name);
  std::vector<std::uint32_t> nearest = noise<std::uint32_t>(size, 4);
  Random random(seed_from(name) + 1);
  std::uint32_t latest = kNoSeed;
  std::vector<std::uint32_t> first;
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width && first.size() < 64; ++x) {
      if (seeds[std::size_t{y} * size.stride + x] != 0) {
        first.push_back(y << 16U | x);
      }
    }
  }
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      const std::size_t cell = std::size_t{y} * size.stride + x;
      latest = seeds[cell] != 0 ? (y << 16U | x) : latest;
      const std::uint64_t kind = random.below(4);
      const std::uint32_t any = first.empty() ? kNoSeed : first[random.below(first.size())];
      nearest[cell] = seeds[cell] != 0 || kind == 0 ? latest : kind == 1 ? any : kNoSeed;
    }
  }
  return nearest;
}

struct FloodGrid {
  CaseSize size;
  SeedPattern pattern;
  [[nodiscard]] std::string name() const { return size_name(size) + " " + std::string(to_string(pattern)); }
  [[nodiscard]] Extent threads() const { return {size.width, size.height, 1}; }
};

struct InitCase : FloodGrid {
  using Kernel = JumpFloodInit;
  [[nodiscard]] KernelCase make(const std::string& named) const {
    return make_case<JumpFloodInit>(
        named, {size.width, size.height, size.stride}, threads(),
        {grid_buffer(size, seeds_for(pattern, size, named)), grid_buffer(size, noise<std::uint32_t>(size, 5))});
  }
};

struct StepCase : FloodGrid {
  using Kernel = JumpFloodStep;
  std::uint32_t step = 1;
  [[nodiscard]] std::string name() const { return FloodGrid::name() + " step " + std::to_string(step); }
  [[nodiscard]] KernelCase make(const std::string& named) const {
    return make_case<JumpFloodStep>(
        named, {size.width, size.height, size.stride, step}, threads(),
        {grid_buffer(size, half_flooded(pattern, size, named)), grid_buffer(size, noise<std::uint32_t>(size, 6))});
  }
};

struct DistanceCase : FloodGrid {
  using Kernel = JumpFloodDistance;
  std::uint32_t radius = 1;
  [[nodiscard]] std::string name() const { return FloodGrid::name() + " R" + std::to_string(radius); }
  [[nodiscard]] KernelCase make(const std::string& named) const {
    return make_case<JumpFloodDistance>(
        named, {size.width, size.height, size.stride, radius}, threads(),
        {grid_buffer(size, half_flooded(pattern, size, named)), grid_buffer(size, noise<std::uint16_t>(size, 7))});
  }
};

/// add(size, pattern, turn): every size with every pattern, every small size with two patterns.
template <class Add>
void for_each_grid(Add add) {
  for_each_size([&](CaseSize size) {
    for (const SeedPattern pattern : kCasePatterns) {
      add(size, pattern, 0);
    }
  });
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    add(size, in_turn(kCasePatterns, turn), turn / 2);
    add(size, in_turn(kCasePatterns, turn + 3), turn / 3);
  });
  for (const CaseSize& size : kLongSizes) {
    add(size, SeedPattern::kOne, 0);
    add(size, SeedPattern::kSparse, 0);
  }
}

/// A case of every grid: with each number of the list on the larger ones, with one in turn on the small ones.
template <class Shape, std::size_t kCount>
void add_grids(std::vector<KernelCaseSource>& list, const std::uint32_t (&numbers)[kCount]) {
  for_each_grid([&](CaseSize size, SeedPattern pattern, std::uint32_t turn) {
    if (size.width > kSmallSide || size.height > kSmallSide) {
      for (const std::uint32_t number : numbers) {
        add_case(list, Shape{{size, pattern}, number});
      }
    } else {
      add_case(list, Shape{{size, pattern}, in_turn(numbers, turn)});
    }
  });
}

KernelCase draw_init(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  return InitCase{{size, draw_pattern(random)}}.make(name);
}
template <class Shape, std::uint32_t kMostNumber>
KernelCase draw_with(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  const SeedPattern pattern = draw_pattern(random);
  return Shape{{size, pattern}, 1 + draw_count(random, kMostNumber - 1)}.make(name);
}

void add_all_passes(std::vector<KernelCaseSource>& list) {
  constexpr FloodGrid kBench{{1024, 1024, 1024}, SeedPattern::kWalls};
  for_each_grid([&](CaseSize size, SeedPattern pattern, std::uint32_t) { add_case(list, InitCase{{size, pattern}}); });
  add_case(list, InitCase{kBench}, CaseUse::kBenchmark);
  add_grids<StepCase>(list, kSteps);
  add_case(list, StepCase{kBench, 1}, CaseUse::kBenchmark);
  add_case(list, StepCase{kBench, 256}, CaseUse::kBenchmark);
  add_grids<DistanceCase>(list, kCaseRadii);
  add_case(list, DistanceCase{kBench, 255}, CaseUse::kBenchmark);
  for (const CaseSize& size : kLargeSizes) {
    const FloodGrid grid{size, SeedPattern::kWalls};
    add_case(list, InitCase{grid}, CaseUse::kLarge);
    add_case(list, StepCase{grid, 512}, CaseUse::kLarge);
    add_case(list, DistanceCase{grid, 255}, CaseUse::kLarge);
  }
}

}  // namespace

CaseGroup JumpFloodInit::cases() {
  return {add_all_passes,
          {{&JumpFloodInit::info(), draw_init},
           {&JumpFloodStep::info(), draw_with<StepCase, 32767>},
           {&JumpFloodDistance::info(), draw_with<DistanceCase, 255>}}};
}

}  // namespace gdtslam
