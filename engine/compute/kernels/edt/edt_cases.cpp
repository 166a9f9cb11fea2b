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
  [[nodiscard]] std::vector<std::uint8_t> seeds(const std::string& named) const {
    return make_seeds(pattern, size.width, size.height, size.stride, seed_from(named));
  }
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

struct Columns {
  using Kernel = EdtColumns;
  static KernelCase make(const std::string& name, const EdtGrid& grid) {
    return make_case<EdtColumns>(
        name, grid.params(), {grid.size.width, 1, 1},
        {grid_buffer(grid.size, grid.seeds(name)), grid_buffer(grid.size, noise<std::uint8_t>(grid.size, 1))});
  }
};
struct Rows {
  using Kernel = EdtRows;
  static KernelCase make(const std::string& name, const EdtGrid& grid) {
    return make_case<EdtRows>(name, grid.params(), {1, grid.size.height, 1},
                              {grid_buffer(grid.size, column_distances(grid.size, grid.seeds(name), grid.radius)),
                               grid_buffer(grid.size, noise<std::uint16_t>(grid.size, 3))});
  }
};

template <class Pass>
void add_grid(std::vector<KernelCaseSource>& list, const EdtGrid& grid, bool benchmark = false) {
  add_case<typename Pass::Kernel>(
      list, grid.name(), [grid](const std::string& name) { return Pass::make(name, grid); }, benchmark);
}

/// Every size with every pattern and every radius, every small size with two patterns and one radius.
template <class Pass>
void add_grids(std::vector<KernelCaseSource>& list) {
  for (const SeedPattern pattern : kCasePatterns) {
    for (const std::uint32_t radius : kRadii) {
      for (const CaseSize& size : kCaseSizes) {
        if (size.width > kSmallSide || size.height > kSmallSide) {
          add_grid<Pass>(list, {size, pattern, radius});
        }
      }
    }
  }
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    add_grid<Pass>(list, {size, in_turn(kCasePatterns, turn), in_turn(kRadii, turn / 2)});
    add_grid<Pass>(list, {size, in_turn(kCasePatterns, turn + 3), in_turn(kRadii, turn / 3)});
  });
  for (const CaseSize& size : kLongSizes) {
    add_grid<Pass>(list, {size, SeedPattern::kNone, kLargestRadius});
    add_grid<Pass>(list, {size, SeedPattern::kOne, kLargestRadius});
    add_grid<Pass>(list, {size, SeedPattern::kSparse, kRadii[0]});
    add_grid<Pass>(list, {size, SeedPattern::kCorners, kLargestRadius});  // all that is near is at the edges
  }
  for (const CaseSize& size : {CaseSize{257, 131, 288}, CaseSize{129, 40, 132}, CaseSize{33, 19, 36}}) {
    add_grid<Pass>(list, {size, SeedPattern::kCorners, kLargestRadius});
  }
  for (const CaseSize& size : kLargeSizes) {
    const EdtGrid grid{size, SeedPattern::kWalls, kRadii[1]};
    add_large_case<typename Pass::Kernel>(list, grid.name(),
                                          [grid](const std::string& name) { return Pass::make(name, grid); });
  }
}

template <class Pass>
KernelCase draw(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  const SeedPattern pattern = draw_pattern(random);
  return Pass::make(name, {size, pattern, 1 + draw_count(random, 254)});
}

}  // namespace

void add_edt_cases(std::vector<KernelCaseSource>& list) {
  add_grids<Columns>(list);
  add_grid<Columns>(list, {kBenchSize, SeedPattern::kWalls, 20}, true);
  add_grids<Rows>(list);
  add_grid<Rows>(list, {kBenchSize, SeedPattern::kWalls, 20}, true);
  add_grid<Rows>(list, {kBenchSize, SeedPattern::kWalls, 255}, true);
}

void add_edt_draws(std::vector<RandomKernel>& list) {
  list.push_back({&EdtColumns::info(), draw<Columns>});
  list.push_back({&EdtRows::info(), draw<Rows>});
}

}  // namespace gdtslam
