#include "engine/compute/cases/case_builder.hpp"
#include "jump_flood.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kSteps[] = {1, 2, 16, 128};

/// A state of the flood: seeds hold themselves, a quarter of the other cells the latest seed before them, a quarter any
/// of the first 64. So among equally far seeds the first one offered does not always have the lower index.
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

/// A case for every grid: with each number of the list on the larger ones, with one in turn on the small ones.
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

/// Cells: mostly inside, some named twice, some just outside and some far outside.
std::vector<std::uint32_t> scatter_cells(CaseSize size, std::uint32_t count, Random& random) {
  const auto cell = [](std::uint64_t x, std::uint64_t y) { return static_cast<std::uint32_t>(y << 16U | x); };
  std::vector<std::uint32_t> cells(count);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::uint64_t kind = random.below(8);
    if (kind == 0 && i > 0) {
      cells[i] = cells[random.below(i)];
    } else if (kind == 1) {
      cells[i] = random.below(2) == 0 ? cell(size.width, random.below(size.height + 1))
                                      : cell(random.below(size.width + 1), size.height);
    } else if (kind == 2) {
      cells[i] = static_cast<std::uint32_t>(random.bits());
    } else {
      const std::uint64_t y = random.below(size.height + 1);
      cells[i] = cell(random.below(size.width + 1), y);
    }
  }
  return cells;
}

struct ScatterCase {
  using Kernel = SeedScatter;
  CaseSize size;
  std::uint32_t count = 361;
  [[nodiscard]] std::string name() const { return size_name(size) + " " + std::to_string(count) + " points"; }
  [[nodiscard]] KernelCase make(const std::string& named) const {
    Random random(seed_from(named));
    const std::vector<std::uint32_t> cells = scatter_cells(size, count, random);
    return make_case<SeedScatter>(named, {count, size.width, size.height, size.stride}, {count, 1, 1},
                                  {list_buffer(cells), grid_buffer(size, noise<std::uint8_t>(size, random.bits()))});
  }
};

KernelCase draw_scatter(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  return ScatterCase{size, draw_count(random, 5000)}.make(name);
}

void add_scatters(std::vector<KernelCaseSource>& list) {
  constexpr std::uint32_t kCounts[] = {0, 1, 2, 17, 361};
  for_each_size([&](CaseSize size) {
    for (const std::uint32_t count : kCounts) {
      add_case(list, ScatterCase{size, count});
    }
  });
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    add_case(list, ScatterCase{size, in_turn(kCounts, turn)});
    add_case(list, ScatterCase{size, in_turn(kCounts, turn + 2)});
  });
  for (const CaseSize& size : kLongSizes) {
    add_case(list, ScatterCase{size});
  }
  add_case(list, ScatterCase{{512, 512, 512}, 40000});
  for (const CaseSize& size : kLargeSizes) {
    add_case(list, ScatterCase{size, 65537}, CaseUse::kLarge);
  }
  add_case(list, ScatterCase{{1024, 1024, 1024}}, CaseUse::kBenchmark);
}

void add_all_passes(std::vector<KernelCaseSource>& list) {
  constexpr FloodGrid kBench{{1024, 1024, 1024}, SeedPattern::kWalls};
  add_scatters(list);
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

CaseGroup SeedScatter::cases() {
  return {add_all_passes,
          {{&SeedScatter::info(), draw_scatter},
           {&JumpFloodInit::info(), draw_init},
           {&JumpFloodStep::info(), draw_with<StepCase, 32767>},
           {&JumpFloodDistance::info(), draw_with<DistanceCase, 255>}}};
}

}  // namespace gdtslam
