#include "engine/compute/cases/case_builder.hpp"
#include "engine/compute/kernels/field_grow/field_grow.hpp"
#include "seed_scatter.hpp"

namespace gdtslam {
namespace {

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
      cells[i] = cell(random.below(size.width + 1), random.below(size.height + 1));
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

/// A field, and what the new one has beyond it.
struct GrowCase {
  using Kernel = FieldGrow;
  CaseSize old_size;
  std::uint32_t left = 0;
  std::uint32_t below = 0;
  std::uint32_t right = 0;
  std::uint32_t above = 0;
  std::uint32_t cap = 5120;

  [[nodiscard]] CaseSize size() const {
    const std::uint32_t width = left + old_size.width + right;
    return {width, below + old_size.height + above, grid_stride(width)};
  }
  [[nodiscard]] std::string name() const {
    return size_name(old_size) + " to " + size_name(size()) + " at " + std::to_string(left) + "," +
           std::to_string(below);
  }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

KernelCase GrowCase::make(const std::string& named) const {
  const CaseSize grown = size();
  const std::uint64_t random_seed = seed_from(named);
  const FieldGrow::Params params{
      old_size.width, old_size.height, old_size.stride, grown.width, grown.height, grown.stride, left, below, cap};
  return make_case<FieldGrow>(named, params, {grown.width, grown.height, 1},
                              {grid_buffer(old_size, noise<std::uint16_t>(old_size, random_seed)),
                               grid_buffer(grown, noise<std::uint16_t>(grown, random_seed + 1))});
}

KernelCase draw_scatter(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  return ScatterCase{size, draw_count(random, 5000)}.make(name);
}

KernelCase draw_grow(const std::string& name, Random& random) {
  GrowCase grow{.old_size = draw_size(random)};
  grow.left = draw_count(random, 80);
  grow.below = draw_count(random, 80);
  grow.right = draw_count(random, 80);
  grow.above = draw_count(random, 80);
  grow.cap = draw_count(random, 65535);
  return grow.make(name);
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

void add_grows(std::vector<KernelCaseSource>& list) {
  for_each_size([&](CaseSize size) {
    add_case(list, GrowCase{size});
    add_case(list, GrowCase{size, 1});
    add_case(list, GrowCase{size, 3, 5, 2, 1, 65535});
    add_case(list, GrowCase{size, 32, 2, 7, 0, 0});
    add_case(list, GrowCase{size, 0, 1, 64, 33});
  });
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    add_case(list, GrowCase{size, turn % 3, turn % 2, turn / 2 % 5, turn / 3 % 2, 100 * turn});
  });
  for (const CaseSize& size : kLongSizes) {
    add_case(list, GrowCase{size, 3, 2, 1, 4});
  }
  add_case(list, GrowCase{{4096, 1, 4096}, 3, 0, 5, 0});  // one row: cut along it
  for (const CaseSize& size : kLargeSizes) {
    add_case(list, GrowCase{size, 33, 1, 0, 2}, CaseUse::kLarge);
  }
  add_case(list, GrowCase{{1024, 1024, 1024}, 128, 128, 128, 128}, CaseUse::kBenchmark);
}

void add_cases(std::vector<KernelCaseSource>& list) {
  add_scatters(list);
  add_grows(list);
}

}  // namespace

CaseGroup map_cases() { return {add_cases, {{&SeedScatter::info(), draw_scatter}, {&FieldGrow::info(), draw_grow}}}; }

}  // namespace gdtslam
