#include "cases/case_builder.hpp"
#include "gdtslam/compute/kernels/field_grow.hpp"
#include "gdtslam/compute/kernels/seed_scatter.hpp"

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

void add_scatter(std::vector<KernelCaseSource>& list, CaseSize size, std::uint32_t count, bool benchmark) {
  add_case<SeedScatter>(
      list, size_name(size) + " " + std::to_string(count) + " points",
      [=](const std::string& named) {
        Random random(seed_from(named));
        const std::vector<std::uint32_t> cells = scatter_cells(size, count, random);
        return make_case<SeedScatter>(
            named, {count, size.width, size.height, size.stride}, {count, 1, 1},
            {list_buffer(cells), grid_buffer(size, noise<std::uint8_t>(size, random.bits()))});
      },
      benchmark);
}

/// What the new field has beyond the old one.
struct Margins {
  std::uint32_t left;
  std::uint32_t below;
  std::uint32_t right;
  std::uint32_t above;
};

void add_grow(std::vector<KernelCaseSource>& list, CaseSize old_size, Margins margins, std::uint32_t cap,
              bool benchmark) {
  const CaseSize size{margins.left + old_size.width + margins.right, margins.below + old_size.height + margins.above,
                      grid_stride(margins.left + old_size.width + margins.right)};
  add_case<FieldGrow>(
      list,
      size_name(old_size) + " to " + size_name(size) + " at " + std::to_string(margins.left) + "," +
          std::to_string(margins.below),
      [=](const std::string& named) {
        const std::uint64_t random_seed = seed_from(named);
        const FieldGrow::Params params{old_size.width, old_size.height, old_size.stride, size.width, size.height,
                                       size.stride,    margins.left,    margins.below,   cap};
        return make_case<FieldGrow>(named, params, {size.width, size.height, 1},
                                    {grid_buffer(old_size, noise<std::uint16_t>(old_size, random_seed)),
                                     grid_buffer(size, noise<std::uint16_t>(size, random_seed + 1))});
      },
      benchmark);
}

}  // namespace

void add_map_cases(std::vector<KernelCaseSource>& list) {
  for (const CaseSize& size : kCaseSizes) {
    for (const std::uint32_t count : {0U, 1U, 17U, 361U}) {
      add_scatter(list, size, count, false);
    }
  }
  add_scatter(list, {512, 512, 512}, 40000, false);
  add_scatter(list, {1024, 1024, 1024}, 361, true);
  for (const CaseSize& size : kCaseSizes) {
    add_grow(list, size, {0, 0, 0, 0}, 5120, false);
    add_grow(list, size, {1, 0, 0, 0}, 5120, false);
    add_grow(list, size, {3, 5, 2, 1}, 65535, false);
    add_grow(list, size, {32, 2, 7, 0}, 0, false);
    add_grow(list, size, {0, 1, 64, 33}, 5120, false);
  }
  add_grow(list, {1024, 1024, 1024}, {128, 128, 128, 128}, 5120, true);
}

}  // namespace gdtslam
