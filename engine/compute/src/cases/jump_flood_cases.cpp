#include "cases/case_builder.hpp"
#include "gdtslam/compute/kernels/jump_flood.hpp"

namespace gdtslam {
namespace {

constexpr SeedPattern kPatterns[] = {SeedPattern::kNone, SeedPattern::kOne, SeedPattern::kSparse, SeedPattern::kAll,
                                     SeedPattern::kChecks};
constexpr CaseSize kBenchSize{1024, 1024, 1024};

std::string pattern_name(CaseSize size, SeedPattern pattern) {
  return size_name(size) + " " + std::string(name_of(pattern));
}

std::vector<std::uint8_t> seeds_for(SeedPattern pattern, CaseSize size) {
  return make_seeds(pattern, size.width, size.height, size.stride, seed_from(size_name(size)));
}

/// A state of the flood: seeds know themselves, and half of the other cells some seed that is not always the nearest.
std::vector<std::uint32_t> half_flooded(SeedPattern pattern, CaseSize size) {
  const std::vector<std::uint8_t> seeds = seeds_for(pattern, size);
  std::vector<std::uint32_t> nearest = noise<std::uint32_t>(size, 4);
  Random random(seed_from(pattern_name(size, pattern)));
  std::uint32_t latest = kNoSeed;
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      const std::size_t cell = std::size_t{y} * size.stride + x;
      latest = seeds[cell] != 0 ? (y << 16U | x) : latest;
      nearest[cell] = seeds[cell] != 0 || random.below(2) == 0 ? latest : kNoSeed;
    }
  }
  return nearest;
}

void add_init(std::vector<KernelCaseSource>& list, CaseSize size, SeedPattern pattern, bool benchmark) {
  add_case<JumpFloodInit>(
      list, pattern_name(size, pattern),
      [=](const std::string& name) {
        return make_case<JumpFloodInit>(
            name, {size.width, size.height, size.stride}, {size.width, size.height, 1},
            {grid_buffer(size, seeds_for(pattern, size)), grid_buffer(size, noise<std::uint32_t>(size, 5))});
      },
      benchmark);
}

void add_step(std::vector<KernelCaseSource>& list, CaseSize size, SeedPattern pattern, std::uint32_t step,
              bool benchmark) {
  add_case<JumpFloodStep>(
      list, pattern_name(size, pattern) + " step " + std::to_string(step),
      [=](const std::string& name) {
        return make_case<JumpFloodStep>(
            name, {size.width, size.height, size.stride, step}, {size.width, size.height, 1},
            {grid_buffer(size, half_flooded(pattern, size)), grid_buffer(size, noise<std::uint32_t>(size, 6))});
      },
      benchmark);
}

void add_distance(std::vector<KernelCaseSource>& list, CaseSize size, SeedPattern pattern, bool benchmark) {
  add_case<JumpFloodDistance>(
      list, pattern_name(size, pattern),
      [=](const std::string& name) {
        return make_case<JumpFloodDistance>(
            name, {size.width, size.height, size.stride}, {size.width, size.height, 1},
            {grid_buffer(size, half_flooded(pattern, size)), grid_buffer(size, noise<std::uint32_t>(size, 7))});
      },
      benchmark);
}

}  // namespace

void add_jump_flood_cases(std::vector<KernelCaseSource>& list) {
  for (const CaseSize& size : kCaseSizes) {
    for (const SeedPattern pattern : kPatterns) {
      add_init(list, size, pattern, false);
    }
  }
  add_init(list, kBenchSize, SeedPattern::kWalls, true);
  for (const CaseSize& size : kCaseSizes) {
    for (const SeedPattern pattern : kPatterns) {
      for (const std::uint32_t step : {1U, 2U, 16U, 128U}) {
        add_step(list, size, pattern, step, false);
      }
    }
  }
  add_step(list, kBenchSize, SeedPattern::kWalls, 1, true);
  add_step(list, kBenchSize, SeedPattern::kWalls, 256, true);
  for (const CaseSize& size : kCaseSizes) {
    for (const SeedPattern pattern : kPatterns) {
      add_distance(list, size, pattern, false);
    }
  }
  add_distance(list, kBenchSize, SeedPattern::kWalls, true);
}

}  // namespace gdtslam
