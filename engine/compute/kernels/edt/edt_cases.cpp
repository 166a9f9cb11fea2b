#include "edt.hpp"
#include "engine/compute/cases/case_builder.hpp"

namespace gdtslam {
namespace {

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
    for (const std::uint32_t radius : kCaseRadii) {
      for_each_size([&](CaseSize size) { add_case(list, Pass{{size, pattern, radius}}); });
    }
  }
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    add_case(list, Pass{{size, in_turn(kCasePatterns, turn), in_turn(kCaseRadii, turn / 2)}});
    add_case(list, Pass{{size, in_turn(kCasePatterns, turn + 3), in_turn(kCaseRadii, turn / 3)}});
  });
  for (const CaseSize& size : kLongSizes) {
    add_case(list, Pass{{size, SeedPattern::kNone, kLargestRadius}});
    add_case(list, Pass{{size, SeedPattern::kOne, kLargestRadius}});
    add_case(list, Pass{{size, SeedPattern::kSparse, kCaseRadii[0]}});
    add_case(list, Pass{{size, SeedPattern::kCorners, kLargestRadius}});  // all that is near is at the edges
  }
  for (const CaseSize& size : {CaseSize{257, 131, 288}, CaseSize{129, 40, 132}, CaseSize{33, 19, 36}}) {
    add_case(list, Pass{{size, SeedPattern::kCorners, kLargestRadius}});
  }
  for (const CaseSize& size : kLargeSizes) {
    add_case(list, Pass{{size, SeedPattern::kWalls, kCaseRadii[1]}}, CaseUse::kLarge);
  }
}

template <class Pass>
KernelCase draw(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  const SeedPattern pattern = draw_pattern(random);
  return Pass{{size, pattern, 1 + draw_count(random, 254)}}.make(name);
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

void add_edt_cases(std::vector<KernelCaseSource>& list) {
  add_grids<Columns>(list);
  add_case(list, Columns{{kBenchSize, SeedPattern::kWalls, 20}}, CaseUse::kBenchmark);
  add_grids<Rows>(list);
  add_case(list, Rows{{kBenchSize, SeedPattern::kWalls, 20}}, CaseUse::kBenchmark);
  add_case(list, Rows{{kBenchSize, SeedPattern::kWalls, 255}}, CaseUse::kBenchmark);
  add_scatters(list);
}

}  // namespace

CaseGroup EdtColumns::cases() {
  return {add_edt_cases,
          {{&EdtColumns::info(), draw<Columns>}, {&EdtRows::info(), draw<Rows>}, {&SeedScatter::info(), draw_scatter}}};
}

}  // namespace gdtslam
