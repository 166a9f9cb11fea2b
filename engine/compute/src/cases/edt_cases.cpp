#include "cases/case_builder.hpp"
#include "gdtslam/compute/kernels/edt.hpp"

namespace gdtslam {
namespace {

constexpr SeedPattern kPatterns[] = {SeedPattern::kNone, SeedPattern::kOne, SeedPattern::kSparse,
                                     SeedPattern::kHalf, SeedPattern::kAll, SeedPattern::kChecks};

EdtColumns::Params params_for(CaseSize size, std::uint32_t radius) {
  return {size.width, size.height, size.stride, radius};
}

std::vector<std::uint8_t> seeds_for(SeedPattern pattern, CaseSize size) {
  return make_seeds(pattern, size.width, size.height, size.stride, seed_from(size_name(size)));
}

template <class K, class Out>
void add_columns(std::vector<KernelCaseSource>& list, CaseSize size, SeedPattern pattern, std::uint32_t radius,
                 bool benchmark) {
  const std::string name = size_name(size) + " " + std::string(name_of(pattern)) + " R" + std::to_string(radius);
  add_case<K>(
      list, name,
      [=](const std::string& named) {
        return make_case<K>(named, params_for(size, radius), {size.width, 1, 1},
                            {grid_buffer(size, seeds_for(pattern, size)), grid_buffer(size, noise<Out>(size, 1))});
      },
      benchmark);
}

/// Distances along the columns as the first pass leaves them, by the plainest loop: the input of the second pass.
template <class T>
std::vector<T> column_distances(CaseSize size, SeedPattern pattern, std::uint32_t none) {
  const std::vector<std::uint8_t> seeds = seeds_for(pattern, size);
  std::vector<T> distances = noise<T>(size, 2);
  for (std::uint32_t x = 0; x < size.width; ++x) {
    std::uint32_t down = none;
    std::uint32_t up = none;
    for (std::uint32_t y = 0; y < size.height; ++y) {
      const std::size_t cell = std::size_t{y} * size.stride + x;
      down = seeds[cell] != 0 ? 0 : (down < none ? down + 1 : none);
      distances[cell] = static_cast<T>(down);
    }
    for (std::uint32_t y = size.height; y-- > 0;) {
      const std::size_t cell = std::size_t{y} * size.stride + x;
      up = seeds[cell] != 0 ? 0 : (up < none ? up + 1 : none);
      distances[cell] = static_cast<T>(up < distances[cell] ? up : distances[cell]);
    }
  }
  return distances;
}

template <class K, class In, class Out>
void add_rows(std::vector<KernelCaseSource>& list, CaseSize size, SeedPattern pattern, std::uint32_t radius,
              std::uint32_t none, bool benchmark) {
  const std::string name = size_name(size) + " " + std::string(name_of(pattern)) + " R" + std::to_string(radius);
  add_case<K>(
      list, name,
      [=](const std::string& named) {
        return make_case<K>(
            named, params_for(size, radius), {1, size.height, 1},
            {grid_buffer(size, column_distances<In>(size, pattern, none)), grid_buffer(size, noise<Out>(size, 3))});
      },
      benchmark);
}

template <class Add>
void for_each_grid(Add add) {
  for (const CaseSize& size : kCaseSizes) {
    for (const SeedPattern pattern : kPatterns) {
      add(size, pattern);
    }
  }
}

constexpr CaseSize kBenchSize{1024, 1024, 1024};

}  // namespace

void add_edt_cases(std::vector<KernelCaseSource>& list) {
  for_each_grid([&](CaseSize size, SeedPattern pattern) {
    for (const std::uint32_t radius : {1U, 20U, 255U}) {
      add_columns<EdtColumns, std::uint8_t>(list, size, pattern, radius, false);
    }
  });
  add_columns<EdtColumns, std::uint8_t>(list, kBenchSize, SeedPattern::kWalls, 20, true);
  for_each_grid([&](CaseSize size, SeedPattern pattern) {
    for (const std::uint32_t radius : {1U, 20U, 255U}) {
      add_rows<EdtRows, std::uint8_t, std::uint16_t>(list, size, pattern, radius, radius, false);
    }
  });
  add_rows<EdtRows, std::uint8_t, std::uint16_t>(list, kBenchSize, SeedPattern::kWalls, 20, 20, true);
  add_rows<EdtRows, std::uint8_t, std::uint16_t>(list, kBenchSize, SeedPattern::kWalls, 255, 255, true);
  for_each_grid([&](CaseSize size, SeedPattern pattern) {
    add_columns<EdtFullColumns, std::uint32_t>(list, size, pattern, 0, false);
  });
  add_columns<EdtFullColumns, std::uint32_t>(list, kBenchSize, SeedPattern::kWalls, 0, true);
  for_each_grid([&](CaseSize size, SeedPattern pattern) {
    add_rows<EdtFullRows, std::uint32_t, std::uint32_t>(list, size, pattern, 0, kNoSeed, false);
  });
  add_rows<EdtFullRows, std::uint32_t, std::uint32_t>(list, kBenchSize, SeedPattern::kWalls, 0, kNoSeed, true);
}

}  // namespace gdtslam
