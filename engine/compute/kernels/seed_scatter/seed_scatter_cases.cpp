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

KernelCase scatter_case(const std::string& name, CaseSize size, std::uint32_t count) {
  Random random(seed_from(name));
  const std::vector<std::uint32_t> cells = scatter_cells(size, count, random);
  return make_case<SeedScatter>(name, {count, size.width, size.height, size.stride}, {count, 1, 1},
                                {list_buffer(cells), grid_buffer(size, noise<std::uint8_t>(size, random.bits()))});
}

std::string scatter_name(CaseSize size, std::uint32_t count) {
  return size_name(size) + " " + std::to_string(count) + " points";
}

void add_scatter(std::vector<KernelCaseSource>& list, CaseSize size, std::uint32_t count, bool benchmark = false) {
  add_case<SeedScatter>(
      list, scatter_name(size, count), [=](const std::string& name) { return scatter_case(name, size, count); },
      benchmark);
}

/// A field, and what the new one has beyond it.
struct GrowCase {
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
};

KernelCase grow_case(const std::string& name, const GrowCase& grow) {
  const CaseSize old_size = grow.old_size;
  const CaseSize size = grow.size();
  const std::uint64_t random_seed = seed_from(name);
  const FieldGrow::Params params{old_size.width, old_size.height, old_size.stride, size.width, size.height,
                                 size.stride,    grow.left,       grow.below,      grow.cap};
  return make_case<FieldGrow>(name, params, {size.width, size.height, 1},
                              {grid_buffer(old_size, noise<std::uint16_t>(old_size, random_seed)),
                               grid_buffer(size, noise<std::uint16_t>(size, random_seed + 1))});
}

void add_grow(std::vector<KernelCaseSource>& list, const GrowCase& grow, bool benchmark = false) {
  add_case<FieldGrow>(
      list, grow.name(), [grow](const std::string& name) { return grow_case(name, grow); }, benchmark);
}

KernelCase draw_scatter(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  return scatter_case(name, size, draw_count(random, 5000));
}

KernelCase draw_grow(const std::string& name, Random& random) {
  GrowCase grow{draw_size(random)};
  grow.left = draw_count(random, 80);
  grow.below = draw_count(random, 80);
  grow.right = draw_count(random, 80);
  grow.above = draw_count(random, 80);
  grow.cap = draw_count(random, 65535);
  return grow_case(name, grow);
}

void add_scatters(std::vector<KernelCaseSource>& list) {
  constexpr std::uint32_t kCounts[] = {0, 1, 2, 17, 361};
  for (const CaseSize& size : kCaseSizes) {
    for (const std::uint32_t count : kCounts) {
      if (size.width > kSmallSide || size.height > kSmallSide) {
        add_scatter(list, size, count);
      }
    }
  }
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    add_scatter(list, size, in_turn(kCounts, turn));
    add_scatter(list, size, in_turn(kCounts, turn + 2));
  });
  for (const CaseSize& size : kLongSizes) {
    add_scatter(list, size, 361);
  }
  add_scatter(list, {512, 512, 512}, 40000);
  for (const CaseSize& size : kLargeSizes) {
    add_large_case<SeedScatter>(list, scatter_name(size, 65537),
                                [=](const std::string& name) { return scatter_case(name, size, 65537); });
  }
  add_scatter(list, {1024, 1024, 1024}, 361, true);
}

void add_grows(std::vector<KernelCaseSource>& list) {
  for (const CaseSize& size : kCaseSizes) {
    if (size.width > kSmallSide || size.height > kSmallSide) {
      add_grow(list, {size});
      add_grow(list, {size, 1});
      add_grow(list, {size, 3, 5, 2, 1, 65535});
      add_grow(list, {size, 32, 2, 7, 0, 0});
      add_grow(list, {size, 0, 1, 64, 33});
    }
  }
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    add_grow(list, {size, turn % 3, turn % 2, turn / 2 % 5, turn / 3 % 2, 100 * turn});
  });
  for (const CaseSize& size : kLongSizes) {
    add_grow(list, {size, 3, 2, 1, 4});
  }
  add_grow(list, {{4096, 1, 4096}, 3, 0, 5, 0});  // one row: cut along it
  for (const CaseSize& size : kLargeSizes) {
    const GrowCase grow{size, 33, 1, 0, 2};
    add_large_case<FieldGrow>(list, grow.name(), [grow](const std::string& name) { return grow_case(name, grow); });
  }
  add_grow(list, {{1024, 1024, 1024}, 128, 128, 128, 128}, true);
}

}  // namespace

void add_map_cases(std::vector<KernelCaseSource>& list) {
  add_scatters(list);
  add_grows(list);
}

void add_map_draws(std::vector<RandomKernel>& list) {
  list.push_back({&SeedScatter::info(), draw_scatter});
  list.push_back({&FieldGrow::info(), draw_grow});
}

}  // namespace gdtslam
