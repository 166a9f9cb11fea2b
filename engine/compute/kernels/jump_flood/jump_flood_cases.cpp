#include "engine/compute/cases/case_builder.hpp"
#include "jump_flood.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kSteps[] = {1, 2, 16, 128};
constexpr std::uint32_t kRadii[] = {1, 20, 255};
constexpr CaseSize kBenchSize{1024, 1024, 1024};

std::string pattern_name(CaseSize size, SeedPattern pattern) {
  return size_name(size) + " " + std::string(to_string(pattern));
}

std::vector<std::uint8_t> seeds_for(SeedPattern pattern, CaseSize size, const std::string& name) {
  return make_seeds(pattern, size.width, size.height, size.stride, seed_from(name));
}

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

KernelCase init_case(const std::string& name, CaseSize size, SeedPattern pattern) {
  return make_case<JumpFloodInit>(
      name, {size.width, size.height, size.stride}, {size.width, size.height, 1},
      {grid_buffer(size, seeds_for(pattern, size, name)), grid_buffer(size, noise<std::uint32_t>(size, 5))});
}

KernelCase step_case(const std::string& name, CaseSize size, SeedPattern pattern, std::uint32_t step) {
  return make_case<JumpFloodStep>(
      name, {size.width, size.height, size.stride, step}, {size.width, size.height, 1},
      {grid_buffer(size, half_flooded(pattern, size, name)), grid_buffer(size, noise<std::uint32_t>(size, 6))});
}

KernelCase distance_case(const std::string& name, CaseSize size, SeedPattern pattern, std::uint32_t radius) {
  return make_case<JumpFloodDistance>(
      name, {size.width, size.height, size.stride, radius}, {size.width, size.height, 1},
      {grid_buffer(size, half_flooded(pattern, size, name)), grid_buffer(size, noise<std::uint16_t>(size, 7))});
}

std::string step_name(CaseSize size, SeedPattern pattern, std::uint32_t step) {
  return pattern_name(size, pattern) + " step " + std::to_string(step);
}

void add_init(std::vector<KernelCaseSource>& list, CaseSize size, SeedPattern pattern, bool benchmark = false) {
  add_case<JumpFloodInit>(
      list, pattern_name(size, pattern), [=](const std::string& name) { return init_case(name, size, pattern); },
      benchmark);
}

void add_step(std::vector<KernelCaseSource>& list, CaseSize size, SeedPattern pattern, std::uint32_t step,
              bool benchmark = false) {
  add_case<JumpFloodStep>(
      list, step_name(size, pattern, step),
      [=](const std::string& name) { return step_case(name, size, pattern, step); }, benchmark);
}

std::string distance_name(CaseSize size, SeedPattern pattern, std::uint32_t radius) {
  return pattern_name(size, pattern) + " R" + std::to_string(radius);
}

void add_distance(std::vector<KernelCaseSource>& list, CaseSize size, SeedPattern pattern, std::uint32_t radius,
                  bool benchmark = false) {
  add_case<JumpFloodDistance>(
      list, distance_name(size, pattern, radius),
      [=](const std::string& name) { return distance_case(name, size, pattern, radius); }, benchmark);
}

/// add(size, pattern, turn): every size with every pattern, every small size with two patterns.
template <class Add>
void for_each_grid(Add add) {
  for (const CaseSize& size : kCaseSizes) {
    for (const SeedPattern pattern : kCasePatterns) {
      if (size.width > kSmallSide || size.height > kSmallSide) {
        add(size, pattern, 0);
      }
    }
  }
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    add(size, in_turn(kCasePatterns, turn), turn / 2);
    add(size, in_turn(kCasePatterns, turn + 3), turn / 3);
  });
  for (const CaseSize& size : kLongSizes) {
    add(size, SeedPattern::kOne, 0);
    add(size, SeedPattern::kSparse, 0);
  }
}

void add_large(std::vector<KernelCaseSource>& list, CaseSize size) {
  constexpr SeedPattern kWalls = SeedPattern::kWalls;
  add_large_case<JumpFloodInit>(list, pattern_name(size, kWalls),
                                [=](const std::string& name) { return init_case(name, size, kWalls); });
  add_large_case<JumpFloodStep>(list, step_name(size, kWalls, 512),
                                [=](const std::string& name) { return step_case(name, size, kWalls, 512); });
  add_large_case<JumpFloodDistance>(list, distance_name(size, kWalls, 255),
                                    [=](const std::string& name) { return distance_case(name, size, kWalls, 255); });
}

KernelCase draw_init(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  return init_case(name, size, draw_pattern(random));
}
KernelCase draw_step(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  const SeedPattern pattern = draw_pattern(random);
  return step_case(name, size, pattern, 1 + draw_count(random, 32766));
}
KernelCase draw_distance(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  const SeedPattern pattern = draw_pattern(random);
  return distance_case(name, size, pattern, 1 + draw_count(random, 254));
}

}  // namespace

void add_jump_flood_cases(std::vector<KernelCaseSource>& list) {
  for_each_grid([&](CaseSize size, SeedPattern pattern, std::uint32_t) { add_init(list, size, pattern); });
  add_init(list, kBenchSize, SeedPattern::kWalls, true);
  for_each_grid([&](CaseSize size, SeedPattern pattern, std::uint32_t turn) {
    if (size.width > kSmallSide || size.height > kSmallSide) {
      for (const std::uint32_t step : kSteps) {
        add_step(list, size, pattern, step);
      }
    } else {
      add_step(list, size, pattern, in_turn(kSteps, turn));
    }
  });
  add_step(list, kBenchSize, SeedPattern::kWalls, 1, true);
  add_step(list, kBenchSize, SeedPattern::kWalls, 256, true);
  for_each_grid([&](CaseSize size, SeedPattern pattern, std::uint32_t turn) {
    if (size.width > kSmallSide || size.height > kSmallSide) {
      for (const std::uint32_t radius : kRadii) {
        add_distance(list, size, pattern, radius);
      }
    } else {
      add_distance(list, size, pattern, in_turn(kRadii, turn));
    }
  });
  add_distance(list, kBenchSize, SeedPattern::kWalls, 255, true);
  for (const CaseSize& size : kLargeSizes) {
    add_large(list, size);
  }
}

void add_jump_flood_draws(std::vector<RandomKernel>& list) {
  list.push_back({&JumpFloodInit::info(), draw_init});
  list.push_back({&JumpFloodStep::info(), draw_step});
  list.push_back({&JumpFloodDistance::info(), draw_distance});
}

}  // namespace gdtslam
