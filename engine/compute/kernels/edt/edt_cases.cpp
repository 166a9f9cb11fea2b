#include "edt.hpp"
#include "engine/compute/cases/case_builder.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kRadii[] = {1, 20, 255};
constexpr std::uint32_t kLargestRadius = 255;
constexpr CaseSize kBenchSize{1024, 1024, 1024};

/// Seeds on a grid, and the radius of the transform.
struct EdtGrid {
  CaseSize size;
  SeedPattern pattern;
  std::uint32_t radius;

  [[nodiscard]] std::string name() const {
    return size_name(size) + " " + std::string(to_string(pattern)) + " R" + std::to_string(radius);
  }
  [[nodiscard]] EdtColumns::Params params() const { return {size.width, size.height, size.stride, radius}; }
};

/// Distances along the columns as the first pass leaves them, by the plainest loop: the input of the second pass.
std::vector<std::uint8_t> column_distances(CaseSize size, const std::vector<std::uint8_t>& seeds, std::uint32_t none) {
  std::vector<std::uint8_t> distances = noise<std::uint8_t>(size, 2);
  for (std::uint32_t x = 0; x < size.width; ++x) {
    std::uint32_t down = none;
    std::uint32_t up = none;
    for (std::uint32_t y = 0; y < size.height; ++y) {
      const std::size_t cell = std::size_t{y} * size.stride + x;
      down = seeds[cell] != 0 ? 0 : (down < none ? down + 1 : none);
      distances[cell] = static_cast<std::uint8_t>(down);
    }
    for (std::uint32_t y = size.height; y-- > 0;) {
      const std::size_t cell = std::size_t{y} * size.stride + x;
      up = seeds[cell] != 0 ? 0 : (up < none ? up + 1 : none);
      distances[cell] = static_cast<std::uint8_t>(up < distances[cell] ? up : distances[cell]);
    }
  }
  return distances;
}

struct Columns : EdtGrid {
  using Kernel = EdtColumns;
  [[nodiscard]] KernelCase make(const std::string& named) const {
    return make_case<EdtColumns>(
        named, params(), {size.width, 1, 1},
        {grid_buffer(size, seeds_for(pattern, size, named)), grid_buffer(size, noise<std::uint8_t>(size, 1))});
  }
};
struct Rows : EdtGrid {
  using Kernel = EdtRows;
  [[nodiscard]] KernelCase make(const std::string& named) const {
    return make_case<EdtRows>(named, params(), {1, size.height, 1},
                              {grid_buffer(size, column_distances(size, seeds_for(pattern, size, named), radius)),
                               grid_buffer(size, noise<std::uint16_t>(size, 3))});
  }
};

/// Every size with every pattern and every radius, every small size with two patterns and one radius.
template <class Pass>
void add_grids(std::vector<KernelCaseSource>& list) {
  for (const SeedPattern pattern : kCasePatterns) {
    for (const std::uint32_t radius : kRadii) {
      for_each_size([&](CaseSize size) { add_case(list, Pass{{size, pattern, radius}}); });
    }
  }
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    add_case(list, Pass{{size, in_turn(kCasePatterns, turn), in_turn(kRadii, turn / 2)}});
    add_case(list, Pass{{size, in_turn(kCasePatterns, turn + 3), in_turn(kRadii, turn / 3)}});
  });
  for (const CaseSize& size : kLongSizes) {
    add_case(list, Pass{{size, SeedPattern::kNone, kLargestRadius}});
    add_case(list, Pass{{size, SeedPattern::kOne, kLargestRadius}});
    add_case(list, Pass{{size, SeedPattern::kSparse, kRadii[0]}});
    add_case(list, Pass{{size, SeedPattern::kCorners, kLargestRadius}});  // all that is near is at the edges
  }
  for (const CaseSize& size : {CaseSize{257, 131, 288}, CaseSize{129, 40, 132}, CaseSize{33, 19, 36}}) {
    add_case(list, Pass{{size, SeedPattern::kCorners, kLargestRadius}});
  }
  for (const CaseSize& size : kLargeSizes) {
    add_case(list, Pass{{size, SeedPattern::kWalls, kRadii[1]}}, CaseUse::kLarge);
  }
}

template <class Pass>
KernelCase draw(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  const SeedPattern pattern = draw_pattern(random);
  return Pass{{size, pattern, 1 + draw_count(random, 254)}}.make(name);
}

void add_both_passes(std::vector<KernelCaseSource>& list) {
  add_grids<Columns>(list);
  add_case(list, Columns{{kBenchSize, SeedPattern::kWalls, 20}}, CaseUse::kBenchmark);
  add_grids<Rows>(list);
  add_case(list, Rows{{kBenchSize, SeedPattern::kWalls, 20}}, CaseUse::kBenchmark);
  add_case(list, Rows{{kBenchSize, SeedPattern::kWalls, 255}}, CaseUse::kBenchmark);
}

}  // namespace

CaseGroup edt_cases() {
  return {add_both_passes, {{&EdtColumns::info(), draw<Columns>}, {&EdtRows::info(), draw<Rows>}}};
}

}  // namespace gdtslam
